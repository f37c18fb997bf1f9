// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/contact/material.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

TEST(HertzStiffness, IsFourThirdsOfTheReducedModulusTimesTheRootOfTheRadius) {
  const Material rubber{5e6, 0.5};
  const double reduced = 1.0 / (2.0 * (1.0 - 0.25) / 5e6);
  EXPECT_NEAR(hertz_stiffness(rubber, rubber, sphere_on_plane(0.01)), 4.0 / 3.0 * reduced * 0.1,
              1e-6);
}

TEST(HertzStiffness, OfPaperBsPairIsDominatedByItsSofterPart) {
  // 4 / 3 / ((1 - 0.38^2) / 2.8e9 + (1 - 0.33^2) / 70e9) = 4.189e9, by hand.
  EXPECT_NEAR(hertz_stiffness(kPolylacticAcid, kAluminium, 1.0), 4.189e9, 1e6);
}

TEST(SphereOnPlane, IsTheLimitOfALargeSecondSphere) {
  EXPECT_NEAR(sphere_on_sphere(0.02, 1e12), sphere_on_plane(0.02), 1e-12);
  EXPECT_DOUBLE_EQ(sphere_on_sphere(0.02, 0.02), 0.1);
  EXPECT_DOUBLE_EQ(sphere_on_sphere(0.01, 0.03), sphere_on_sphere(0.03, 0.01));
}

}  // namespace
}  // namespace pcavr
