// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/contact/impact.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

double restitution_of(DampingLaw law, double c, double stiffness, double mass, double speed,
                      double exponent) {
  const double damping = hunt_crossley_damping(law, stiffness, c, speed);
  return simulate_impact(HuntCrossley{stiffness, damping, exponent}, mass, speed).restitution;
}

TEST(SimulatedImpact, OnASpringTakesHalfAPeriodAndLosesNothing) {
  const Impact impact = simulate_impact(KelvinVoigt{5000.0, 0.0}, 2.0, 0.3);
  const double omega = std::sqrt(5000.0 / 2.0);
  EXPECT_TRUE(impact.has_separated);
  EXPECT_NEAR(impact.restitution, 1.0, 1e-8);
  EXPECT_NEAR(impact.duration, std::numbers::pi / omega, 1e-8);
  EXPECT_NEAR(impact.max_penetration, 0.3 / omega, 1e-7);  // from a parabola between two steps
}

TEST(SimulatedImpact, OnADampedSpringSeparatesWhereItWouldPull) {
  // x = v / wd exp(-s t) sin(wd t); the acceleration, and so the force, vanishes where
  // tan(wd t) = 2 s wd / (s^2 - wd^2).
  const double m = 2.0, k = 5000.0, b = 40.0, v = 0.3;
  const double s = b / (2.0 * m);
  const double wd = std::sqrt(k / m - s * s);
  const double t = std::atan2(2.0 * s * wd, -(wd * wd - s * s)) / wd;
  const double leaving = v * std::exp(-s * t) * (std::cos(wd * t) - s / wd * std::sin(wd * t));
  const Impact impact = simulate_impact(KelvinVoigt{k, b}, m, v);
  EXPECT_NEAR(impact.restitution, -leaving / v, 1e-8);
  EXPECT_NEAR(impact.duration, t, 1e-8);
}

TEST(SimulatedImpact, IncludesTheMassOfTheMaterial) {
  const Impact impact = simulate_impact(MassDamperSpring{1.0, 0.0, 5000.0}, 1.0, 0.3);
  EXPECT_NEAR(impact.duration, std::numbers::pi * std::sqrt(2.0 / 5000.0), 1e-8);
}

TEST(SimulatedImpact, SatisfiesTheExactRelationForAnyBodyAndExponent) {
  for (const double c : {0.05, 0.2, 0.5, 0.8, 0.95}) {
    EXPECT_NEAR(restitution_of(DampingLaw::exact, c, 1.0, 1.0, 1.0, 1.5), c, 2e-8);
    EXPECT_NEAR(restitution_of(DampingLaw::exact, c, 4e9, 0.7, 0.02, 1.5), c, 2e-8);
    EXPECT_NEAR(restitution_of(DampingLaw::exact, c, 3e3, 12.0, 0.5, 1.0), c, 2e-8);
    EXPECT_NEAR(restitution_of(DampingLaw::exact, c, 1e6, 3.0, 0.1, 2.2), c, 2e-8);
  }
}

TEST(SimulatedImpact, OfInvalidInputDoesNotSeparate) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(simulate_impact(KelvinVoigt{0.0, 1.0}, 1.0, 1.0).has_separated);
  EXPECT_FALSE(simulate_impact(KelvinVoigt{100.0, 1.0}, nan, 1.0).has_separated);
  EXPECT_FALSE(simulate_impact(KelvinVoigt{100.0, 1.0}, 1.0, -1.0).has_separated);
}

TEST(DampingScores, AgreeWithTheTableOfReferenceImpacts) {
  // Percent, in the order of kPublishedDampingLaws; from another integrator, printed with two
  // decimals, or as whole percents where large.
  struct Row {
    double c;
    double percent[7];
  };
  const Row table[] = {{0.05, {-34.21, 0.25, 1227, 1249, 903, 294, 877}},
                       {0.1, {-30.56, 0.99, 565, 587, 416, 117, 391}},
                       {0.3, {-14.60, 1.41, 128, 146, 93.8, 8.90, 73.3}},
                       {0.5, {-5.91, -2.45, 45.0, 59.8, 32.6, -3.48, 18.7}},
                       {0.7, {-2.40, -4.35, 13.7, 24.2, 9.71, -2.92, 3.24}},
                       {0.8, {-1.43, -4.00, 5.89, 13.6, 4.11, -1.58, 0.87}},
                       {0.9, {-0.68, -2.62, 1.46, 5.82, 1.00, -0.45, 0.10}}};
  for (const Row& row : table) {
    const auto scores = score_damping_laws(row.c);
    for (std::size_t i = 0; i < scores.size(); ++i) {
      const double percent = 100.0 * scores[i].relative_error;
      const double printed = row.percent[i];
      const double tolerance =
          std::abs(printed) < 10.0 ? 0.0051 : 0.00051 * std::abs(printed) + 0.051;
      EXPECT_NEAR(percent, printed, std::abs(printed) > 100.0 ? 0.51 : tolerance)
          << name_of(scores[i].law) << " at " << row.c;
    }
  }
}

TEST(BestPublishedDampingLaw, IsHerbertMcWhannellFromThreeQuartersOnlyNotFromSevenTenths) {
  for (const double c : {0.76, 0.8, 0.85, 0.9, 0.95}) {
    EXPECT_EQ(best_published_damping_law(c).law, DampingLaw::herbert_mcwhannell) << c;
  }
  for (const double c : {0.70, 0.72, 0.74}) {
    EXPECT_EQ(best_published_damping_law(c).law, DampingLaw::flores) << c;
  }
}

TEST(BestPublishedDampingLaw, IsGonthierWhereFloresIsNoLongerSmall) {
  for (const double c : {0.05, 0.1, 0.2, 0.3}) {
    EXPECT_EQ(best_published_damping_law(c).law, DampingLaw::gonthier) << c;
  }
}

TEST(Impact, HasTheForceWidthOfAHalfSineOnASpring) {
  const Impact impact = simulate_impact(KelvinVoigt{1000.0, 0.0}, 2.0, 0.3);
  // Std of a half sine over its duration T: T sqrt(1/4 - 2/pi^2).
  const double width =
      impact.duration * std::sqrt(0.25 - 2.0 / (std::numbers::pi * std::numbers::pi));
  EXPECT_NEAR(impact.force_width, width, 1e-3 * width);
}

}  // namespace
}  // namespace pcavr
