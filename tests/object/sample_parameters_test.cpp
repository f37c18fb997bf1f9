// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/sample_parameters.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"

namespace pcavr {
namespace {

ObjectParameters identified_block() {
  ObjectParameters known;
  known.mass = ParameterValue{1.2, {}};
  known.sliding_friction_coefficient = ParameterValue{0.23, 0.02};
  known.viscous_friction = ParameterValue{15.0, 3.0};
  known.contact_stiffness = ParameterValue{2e4, 8e3};
  known.contact_exponent = ParameterValue{1.1, 0.3};
  known.limiting_static_friction_scatter = ParameterValue{0.2, 0.05};
  Eigen::Matrix2d covariance;
  covariance << 4e-4, -0.8 * 0.02 * 3.0, -0.8 * 0.02 * 3.0, 9.0;
  set_correlation({"sliding_friction_coefficient", "viscous_friction"}, covariance, known.sources);
  return known;
}

struct Moments {
  double mean = 0.0, std = 0.0;
};
Moments moments_of(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value, squares += value * value;
  const auto n = static_cast<double>(values.size());
  return {sum / n, std::sqrt(squares / n - sum * sum / (n * n))};
}

TEST(SampleParameters, HaveTheStatedMeanStdAndCorrelation) {
  const ObjectParameters known = identified_block();
  Random random(7);
  std::vector<double> friction, viscous, product;
  for (int i = 0; i < 20000; ++i) {
    const ObjectParameters drawn = sample_parameters(known, random);
    friction.push_back(drawn.sliding_friction_coefficient->value);
    viscous.push_back(drawn.viscous_friction->value);
    product.push_back((friction.back() - 0.23) / 0.02 * (viscous.back() - 15.0) / 3.0);
  }
  EXPECT_NEAR(moments_of(friction).mean, 0.23, 0.0005);
  EXPECT_NEAR(moments_of(friction).std, 0.02, 0.0005);
  EXPECT_NEAR(moments_of(viscous).mean, 15.0, 0.1);
  EXPECT_NEAR(moments_of(viscous).std, 3.0, 0.1);
  EXPECT_NEAR(moments_of(product).mean, -0.8, 0.04);
}

TEST(SampleParameters, HaveSlidingForcesOfTheDrawnFriction) {
  ObjectParameters known = identified_block();
  known.sliding_force = {{0.01, 3.0, 0.06}};
  Random random(5);
  const ObjectParameters drawn = sample_parameters(known, random);
  const auto law = [](const ObjectParameters& of) {
    return of.sliding_friction_coefficient->value * 1.2 * kStandardGravity +
           0.01 * of.viscous_friction->value;
  };
  ASSERT_NE(law(drawn), law(known));
  EXPECT_NEAR(drawn.sliding_force.front().force, 3.0 * law(drawn) / law(known), 1e-12);
}

TEST(SampleParameters, StayInTheRangesOfParameterFilesAndKeepWhatIsNoUncertainty) {
  const ObjectParameters known = identified_block();
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const ObjectParameters drawn = sample_parameters(known, random);
    EXPECT_GT(drawn.contact_stiffness->value, 0.0);
    EXPECT_GE(drawn.contact_exponent->value, 1.0);
    EXPECT_EQ(drawn.mass->value, 1.2);
    EXPECT_EQ(drawn.limiting_static_friction_scatter->value, 0.2);
    EXPECT_FALSE(drawn.friction_radius);
  }
}

TEST(SampleParameters, DependOnTheGeneratorAlone) {
  const ObjectParameters known = identified_block();
  const auto draw = [&](std::uint64_t seed) {
    Random random(seed);
    return sample_parameters(known, random).viscous_friction->value;
  };
  EXPECT_EQ(draw(3), draw(3));
  EXPECT_NE(draw(3), draw(4));
}

TEST(SampleParameters, AreTheKnownOnesWithoutStds) {
  ObjectParameters known;
  known.mass = ParameterValue{1.2, {}};
  Random random(1);
  EXPECT_EQ(sample_parameters(known, random).mass->value, 1.2);
}

}  // namespace
}  // namespace pcavr
