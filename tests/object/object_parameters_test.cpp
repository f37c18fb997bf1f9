// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/object_parameters.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr double kForce = 33.0;  // [N]
constexpr double kStiffness = 3e5, kStiffnessStd = 4.8e4, kExponent = 1.54, kExponentStd = 0.03;
constexpr double kCorrelation = 0.98;

ObjectParameters known_law() {
  ObjectParameters known;
  known.contact_stiffness = {kStiffness, kStiffnessStd};
  known.contact_exponent = {kExponent, kExponentStd};
  return known;
}

void correlate(double correlation, ObjectParameters& known) {
  Eigen::Matrix2d covariance;
  const double mixed = correlation * kStiffnessStd * kExponentStd;
  covariance << kStiffnessStd * kStiffnessStd, mixed, mixed, kExponentStd * kExponentStd;
  set_correlation({"contact.stiffness", "contact.exponent"}, covariance, known.sources);
}

/// Relative, of penetrations by laws drawn from a tenth of that posterior: d is nearly linear
/// there.
double sampled_std(double correlation) {
  Random random(7);
  constexpr int kDraws = 20000;
  constexpr double kShare = 0.1;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double a = random.normal();
    const double b = correlation * a + std::sqrt(1.0 - correlation * correlation) * random.normal();
    const double d = std::pow(kForce / (kStiffness + kShare * kStiffnessStd * a),
                              1.0 / (kExponent + kShare * kExponentStd * b));
    sum += d;
    squares += d * d;
  }
  const double mean = sum / kDraws;
  return std::sqrt(squares / kDraws - mean * mean) / (kShare * mean);
}

TEST(PenetrationStd, IsThatOfCorrelatedStiffnessAndExponent) {
  for (const double correlation : {0.0, 0.5, kCorrelation}) {
    ObjectParameters known = known_law();
    correlate(correlation, known);
    const double expected = sampled_std(correlation);
    EXPECT_NEAR(*penetration_std(known, kForce), expected, 0.03 * expected) << correlation;
  }
}

TEST(PenetrationStd, TakesTheExponentForExactWithoutACorrelation) {
  const ObjectParameters known = known_law();
  EXPECT_DOUBLE_EQ(*penetration_std(known, kForce), kStiffnessStd / kStiffness / kExponent);
  ObjectParameters linear;
  linear.contact_stiffness = {8000.0, 400.0};
  EXPECT_DOUBLE_EQ(*penetration_std(linear, kForce), 0.05);
}

TEST(PenetrationStd, IsEmptyForAStiffnessWithoutAStd) {
  ObjectParameters known;
  EXPECT_FALSE(penetration_std(known, kForce));
  known.contact_stiffness = ParameterValue{8000.0};
  EXPECT_FALSE(penetration_std(known, kForce));
}

}  // namespace
}  // namespace pcavr
