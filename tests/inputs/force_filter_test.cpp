// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/force_filter.hpp"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "inputs/simulated_series.hpp"

namespace pcavr {
namespace {

/// The fault of a probe whose force is behind a low pass of first order; `cutoff` 0: of none.
std::optional<InputFault> fault_behind(double cutoff) {
  static const IdentificationInput sound = simulated_input(20.0);
  std::vector<Eigen::Vector3d> force = sound.force_base;
  for (std::size_t i = 1; cutoff > 0.0 && i < force.size(); ++i) {
    const double interval = sound.t_force[i] - sound.t_force[i - 1];
    const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * cutoff * interval);
    force[i] = force[i - 1] + share * (sound.force_base[i] - force[i - 1]);
  }
  const Segmentation found = segment_contacts(sound.t_force, force, sound.t_tool, sound.p_base_tip);
  return force_filter_fault(found, sound.t_force);
}

TEST(ForceFilter, IsNamedWithItsFrequency) {
  for (const double cutoff : {1.2, 1.8, 3.0}) {
    const std::optional<InputFault> fault = fault_behind(cutoff);
    ASSERT_TRUE(fault.has_value()) << cutoff << " Hz";
    EXPECT_TRUE(fault->is_of_force_only());
    const std::string& message = fault->error.message;
    const double stated = std::stod(message.substr(message.find("about ") + 6));
    EXPECT_NEAR(stated, cutoff, 0.25 * cutoff) << message;
  }
}

TEST(ForceFilter, IsNotClaimedWhereThereIsNoneOrAUsualOne) {
  for (const double cutoff : {0.0, 100.0, 20.0}) {
    const std::optional<InputFault> fault = fault_behind(cutoff);
    EXPECT_FALSE(fault.has_value()) << cutoff << " Hz: " << fault->error.message;
  }
}

}  // namespace
}  // namespace pcavr
