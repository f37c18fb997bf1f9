// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "inputs/clock_offsets.hpp"

namespace pcavr {
namespace {

struct Recorded {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> tip, force;
};

/// Presses with smooth reversals, without noise, by Hunt and Crossley's law.
Recorded soft_presses(double depth, double stiffness, double damping) {
  constexpr double kRate = 500.0;
  constexpr double kPeriod = 1.2;  // [s]
  Recorded recorded;
  for (int i = 0; i < 3600; ++i) {
    const double t = i / kRate;
    const double phase = 2.0 * 3.14159265358979 / kPeriod * t;
    const double d = depth * (0.5 - 1.5 * std::cos(phase));
    const double rate = depth * 1.5 * std::sin(phase) * 2.0 * 3.14159265358979 / kPeriod;
    const double power = std::pow(std::max(d, 0.0), 1.5);
    recorded.t.push_back(t);
    recorded.tip.emplace_back(0.4, 0.0, 0.1 - d);
    recorded.force.emplace_back(0.0, 0.0, -std::max(0.0, power * (stiffness + damping * rate)));
  }
  return recorded;
}

TEST(ForceOffset, IsNoneOfADeepPressWithStrongDamping) {
  // At 60 mm/s the damping changes the force by a quarter.
  for (const double shift : {0.0, 0.004, -0.004}) {
    Recorded recorded = soft_presses(0.008, 19000.0, 76000.0);
    for (double& t : recorded.t) t += shift;
    std::vector<double> t_tool = recorded.t;
    for (double& t : t_tool) t -= shift;
    const Segmentation found =
        segment_contacts(recorded.t, recorded.force, t_tool, recorded.tip, {});
    const TimeOffset offset = force_offset(found, recorded.t, PathView(t_tool, recorded.tip));
    ASSERT_TRUE(offset.is_known);
    EXPECT_NEAR(offset.offset, shift, 2e-4);
  }
}

}  // namespace
}  // namespace pcavr
