// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/contact/damping.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(ExactDampingFactor, HasTheTabulatedValues) {
  const double table[][2] = {{0.05, 20.000}, {0.1, 9.998}, {0.3, 3.087}, {0.5, 1.433},
                             {0.7, 0.635},   {0.8, 0.373}, {0.9, 0.166}};
  for (const auto& [c, chi] : table) {
    EXPECT_NEAR(exact_damping_factor(c), chi, 0.5001e-3) << c;  // three decimals were printed
  }
}

TEST(ExactDampingFactor, SolvesItsEquation) {
  for (double c = 0.1; c < 0.95; c += 0.01) {
    const double chi = exact_damping_factor(c);
    EXPECT_NEAR(chi * (1.0 + c), std::log((1.0 + chi) / (1.0 - chi * c)), 1e-10) << c;
  }
}

TEST(ExactDampingFactor, ApproachesOneOverCForSmallRestitution) {
  for (const double c : {1e-300, 1e-30, 1e-6, 1e-3, 0.02}) {
    EXPECT_NEAR(exact_damping_factor(c) * c, 1.0, 1e-12) << c;
  }
}

TEST(ExactDampingFactor, ApproachesTheSmallLossLimitNearOne) {
  // chi = 3 d / 2 + 6 d^2 / 4 ... to second order in d = 1 - c, so chi / d - 3/2 is of the order d.
  for (const double d : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const double c = 1.0 - d;
    EXPECT_NEAR(exact_damping_factor(c) / (1.0 - c), 1.5, 3.0 * d + 1e-9) << d;
  }
}

TEST(ExactDampingFactor, DecreasesMonotonically) {
  double before = std::numeric_limits<double>::infinity();
  for (int i = 1; i < 2000; ++i) {
    const double chi = exact_damping_factor(i / 2000.0);
    EXPECT_LT(chi, before) << i;
    before = chi;
  }
}

TEST(DampingFactor, IsZeroForALosslessImpactAndInfiniteForNone) {
  for (const DampingLaw law : kPublishedDampingLaws) {
    EXPECT_EQ(damping_factor(law, 1.0), 0.0) << name_of(law);
    EXPECT_EQ(damping_factor(law, 0.0), std::numeric_limits<double>::infinity()) << name_of(law);
    EXPECT_TRUE(std::isnan(damping_factor(law, kNaN))) << name_of(law);
  }
  EXPECT_EQ(damping_factor(DampingLaw::exact, 1.0), 0.0);
  EXPECT_EQ(damping_factor(DampingLaw::exact, -0.1), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(damping_factor(DampingLaw::exact, kNaN)));
}

TEST(DampingFactor, FollowsThePublishedFormulasAtOneHalf) {
  EXPECT_DOUBLE_EQ(damping_factor(DampingLaw::flores, 0.5), 1.6);
  EXPECT_DOUBLE_EQ(damping_factor(DampingLaw::gonthier, 0.5), 1.5);
  EXPECT_DOUBLE_EQ(damping_factor(DampingLaw::lankarani_nikravesh, 0.5), 0.5625);
  EXPECT_DOUBLE_EQ(damping_factor(DampingLaw::lee_wang, 0.5), 0.375);
  EXPECT_DOUBLE_EQ(damping_factor(DampingLaw::hunt_crossley, 0.5), 0.75);
  EXPECT_DOUBLE_EQ(damping_factor(DampingLaw::zhiying_qishao, 0.5), 0.5625 * std::exp(1.0));
  EXPECT_DOUBLE_EQ(damping_factor(DampingLaw::herbert_mcwhannell, 0.5), 1.0);
}

/// The test at 1/2 does not suffice: Herbert and McWhannell's square is zero there, and c and 1 - c
/// are the same. These are fractions by hand from the formulas as the literature gives them
/// (compared in Alves et al. 2015, table 1).
TEST(DampingFactor, FollowsThePublishedFormulasAtOneAndFourFifths) {
  struct Row {
    DampingLaw law;
    double at_one_fifth, at_four_fifths;
  };
  const Row rows[] = {
      {DampingLaw::flores, 32.0 / 5.0, 2.0 / 5.0},                 // 8 (1 - c) / (5 c)
      {DampingLaw::gonthier, 24.0 / 5.0, 9.0 / 20.0},              // (1 - c^2) / c
      {DampingLaw::lankarani_nikravesh, 18.0 / 25.0, 27.0 / 100},  // 3 (1 - c^2) / 4
      {DampingLaw::lee_wang, 3.0 / 5.0, 3.0 / 20.0},               // 3 (1 - c) / 4
      {DampingLaw::hunt_crossley, 6.0 / 5.0, 3.0 / 10.0},          // 3 (1 - c) / 2
      // 3 (1 - c^2) exp(2 (1 - c)) / 4; exp(1.6) and exp(0.4)
      {DampingLaw::zhiying_qishao, 0.72 * 4.953032424395115, 0.27 * 1.4918246976412703},
      {DampingLaw::herbert_mcwhannell, 10.0 / 7.0, 5.0 / 14.0},  // 6 (1 - c) / ((2 c - 1)^2 + 3)
  };
  for (const Row& row : rows) {
    EXPECT_NEAR(damping_factor(row.law, 0.2), row.at_one_fifth, 1e-14) << name_of(row.law);
    EXPECT_NEAR(damping_factor(row.law, 0.8), row.at_four_fifths, 1e-14) << name_of(row.law);
  }
}

TEST(HuntCrossleyDamping, ScalesWithStiffnessOverSpeed) {
  EXPECT_DOUBLE_EQ(hunt_crossley_damping(DampingLaw::gonthier, 1000.0, 0.5, 0.1), 15000.0);
}

TEST(MeasuredRestitution, ComparesTheSpeedsAlongTheNormalOnly) {
  ImpactVelocities v;
  v.normal = {0.0, 0.0, -2.0};
  v.tool_before = {0.3, 0.0, -0.1};
  v.tool_after = {0.3, 0.1, 0.02};
  v.body_after = {0.0, 0.0, -0.03};
  EXPECT_NEAR(measured_restitution(v).value(), 0.5, 1e-12);
}

TEST(MeasuredRestitution, IsUnknownWithoutApproach) {
  ImpactVelocities v;
  EXPECT_FALSE(measured_restitution(v).has_value());
  v.tool_before = {-0.1, 0.0, 0.0};
  EXPECT_FALSE(measured_restitution(v).has_value());
  v.tool_before = {0.1, 0.0, 0.0};
  EXPECT_TRUE(measured_restitution(v).has_value());
  v.body_after = {kNaN, 0.0, 0.0};
  EXPECT_FALSE(measured_restitution(v).has_value());
}

TEST(DampingLaw, HasAKeyOfItsOwn) {
  for (const DampingLaw law : kPublishedDampingLaws) EXPECT_EQ(damping_law_of(key_of(law)), law);
  EXPECT_EQ(damping_law_of("exact"), DampingLaw::exact);
  EXPECT_FALSE(damping_law_of("criterion"));
}

}  // namespace
}  // namespace pcavr
