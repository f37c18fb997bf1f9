// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/mujoco_contact.hpp"

#include <gtest/gtest.h>

namespace pcavr::detail {
namespace {

TEST(MujocoContact, GivesALinearStiffnessExactly) {
  for (const double stiffness : {2e3, 2e4, 2e5}) {
    const MujocoContact contact = linear_contact(stiffness, 50.0, 1.0 / 0.8, 0.1);
    for (const double depth : {1e-5, 1e-4, 1e-3}) {
      EXPECT_NEAR(mujoco_force(contact, depth, 1.0 / 0.8), stiffness * depth,
                  1e-12 * stiffness * depth);
    }
  }
}

TEST(MujocoContact, FitsAPowerLawAtTheWorkingDepthAndAroundIt) {
  for (const double exponent : {1.2, 1.5, 2.0}) {
    const HuntCrossley law{.stiffness = 2e5, .damping = 1e5, .exponent = exponent};
    const double force = 4.0;
    const MujocoContact contact = fit_mujoco_contact(law, force, 1.0);
    EXPECT_NEAR(mujoco_force(contact, static_penetration(law, force), 1.0), force, 1e-9);
    EXPECT_LT(error_of(contact, law, force, 1.0), 0.12) << exponent;
    EXPECT_GE(contact.solimp[0], 1e-4);
    EXPECT_LE(contact.solimp[1], 0.9999);
  }
}

}  // namespace
}  // namespace pcavr::detail
