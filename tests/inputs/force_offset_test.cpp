// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/inputs/input_monitor.hpp"

#include "inputs/simulated_series.hpp"
#include "physics/inputs/clock_offsets.hpp"

namespace pcavr {
namespace {

struct Recorded {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> tip, force;
};

/// Presses with smooth reversals, without noise, by `force` [N] of penetration [m] and speed.
template <typename Law>
Recorded presses(double depth, Law force) {
  constexpr double kRate = 500.0;
  constexpr double kPeriod = 1.2;  // [s]
  Recorded recorded;
  for (int i = 0; i < 3600; ++i) {
    const double t = i / kRate;
    const double phase = 2.0 * 3.14159265358979 / kPeriod * t;
    const double d = depth * (0.5 - 1.5 * std::cos(phase));
    const double rate = depth * 1.5 * std::sin(phase) * 2.0 * 3.14159265358979 / kPeriod;
    recorded.t.push_back(t);
    recorded.tip.emplace_back(0.4, 0.0, 0.1 - d);
    recorded.force.emplace_back(0.0, 0.0, d > 0.0 ? -std::max(0.0, force(d, rate)) : 0.0);
  }
  return recorded;
}

TimeOffset offset_of(Recorded recorded, double shift) {
  std::vector<double> t_tool = recorded.t;
  for (double& t : recorded.t) t += shift;
  const Segmentation found = segment_contacts(recorded.t, recorded.force, t_tool, recorded.tip, {});
  return force_offset(found, recorded.t, PathView(t_tool, recorded.tip));
}

TEST(ForceOffset, IsNoneOfADeepPressWithStrongDamping) {
  // The damping changes the force by a quarter at 60 mm/s.
  const Recorded recorded = presses(
      0.008, [](double d, double rate) { return std::pow(d, 1.5) * (19000.0 + 76000.0 * rate); });
  for (const double shift : {0.0, 0.004, -0.004}) {
    const TimeOffset offset = offset_of(recorded, shift);
    ASSERT_TRUE(offset.is_known);
    EXPECT_NEAR(offset.offset, shift, 2e-4);
  }
}

TEST(ForceOffset, OfALinearContactMayBeItsDamping) {
  const Recorded recorded =
      presses(0.002, [](double d, double rate) { return 8000.0 * d + 20.0 * rate; });
  EXPECT_FALSE(offset_of(recorded, 0.0).is_known);
  const TimeOffset late = offset_of(recorded, 0.020);
  EXPECT_TRUE(late.is_known);
  EXPECT_NEAR(late.offset, 0.020 - 20.0 / 8000.0, 5e-4);
}

/// Pushes at several speeds that are held for 0.2 s before the release. The friction of an object
/// that comes to rest rises by a tenth [Stribeck], so that the largest force is while it still
/// slides.
Recorded held_pushes() {
  constexpr double kRate = 500.0, kStiffness = 1e5;          // [1/s], [N/m^1.5]
  constexpr double kStop = 0.9, kRelease = 1.1, kEnd = 1.6;  // [s] of each push
  Recorded recorded;
  double object = 0.0;
  for (const double speed : {0.02, 0.03, 0.04, 0.05, 0.06, 0.07}) {
    for (double t = 0.0; t < kEnd; t += 1.0 / kRate) {
      const double slowing = std::clamp((kStop - t) / 0.15, 0.0, 1.0);
      const double v = t > 0.4 ? speed * slowing : 0.0;
      object += v / kRate;
      const double rise =
          0.1 * std::exp(-v / (0.2 * speed)) * std::clamp((kRelease - t) / 0.2, 0.0, 1.0);
      double force = 10.0 * (1.0 + (t > 0.6 ? rise : 0.0));
      if (t < 0.4) force *= std::max(0.0, (t - 0.2) / 0.2);
      double tip = object + std::pow(force / kStiffness, 1.0 / 1.5);
      if (t < 0.2) tip = object - 0.05 * (0.2 - t);
      if (t > kRelease) {
        tip -= 0.05 * (t - kRelease);
        force = kStiffness * std::pow(std::max(0.0, tip - object), 1.5);
      }
      recorded.t.push_back(static_cast<double>(recorded.t.size()) / kRate);
      recorded.tip.emplace_back(tip, 0.0, 0.1);
      recorded.force.emplace_back(force, 0.0, 0.0);
    }
  }
  return recorded;
}

TEST(ForceOffset, IsNoneOfHeldPushes) {
  for (const double shift : {0.0, 0.03}) {
    const TimeOffset offset = offset_of(held_pushes(), shift);
    ASSERT_TRUE(offset.is_known);
    EXPECT_NEAR(offset.offset, shift, std::max(3.0 * offset.std, 1e-3));
    EXPECT_LT(offset.std, 0.005);
  }
}

/// The tip slows down before the face and creeps through what is uncertain of its place, and the
/// recording ends during the push: the time of touch is not known to a tenth of a second.
TEST(ForceOffset, IsNotSaidOfAPushThatWasCut) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const IdentificationInput input = identified_case(ToolTask::push, seed, 2.0).input;
    const InputFindings findings = examine_inputs(series_view(input), {});
    EXPECT_FALSE(findings.is_force_offset_applied)
        << seed << ": " << findings.tool_to_force.offset << " s";
  }
}

}  // namespace
}  // namespace pcavr
