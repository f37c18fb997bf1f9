// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object_identification/combine_with_known.hpp"

#include <cmath>
#include <string>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace pcavr {
namespace {

ObjectParameters friction(double limit, double limit_std, double mu, double mu_std, double viscous,
                          double viscous_std, double correlation) {
  ObjectParameters parameters;
  parameters.limiting_static_friction = ParameterValue{limit, limit_std};
  parameters.sliding_friction_coefficient = ParameterValue{mu, mu_std};
  parameters.viscous_friction = ParameterValue{viscous, viscous_std};
  Eigen::Matrix2d covariance;
  covariance << mu_std * mu_std, correlation * mu_std * viscous_std,
      correlation * mu_std * viscous_std, viscous_std * viscous_std;
  set_correlation({"sliding_friction_coefficient", "viscous_friction"}, covariance,
                  parameters.sources);
  return parameters;
}

ObjectIdentification found_as(const ObjectParameters& parameters) {
  ObjectIdentification found;
  found.parameters = parameters;
  const auto add = [&](const char* name, const ParameterValue& value) {
    found.findings.push_back({name, "", value.value, value.std, true});
  };
  add("limiting_static_friction", *parameters.limiting_static_friction);
  add("sliding_friction_coefficient", *parameters.sliding_friction_coefficient);
  add("viscous_friction", *parameters.viscous_friction);
  return found;
}

TEST(CombineWithKnown, KeepsABetterValueBesideAWorseOne) {
  const ObjectParameters before = friction(3.0, 0.02, 0.2298, 0.005, 5.0, 1.0, 0.0);
  ObjectIdentification found = found_as(friction(3.05, 0.2, 0.2163, 0.021, 6.0, 4.0, 0.0));
  combine_with_known(before, found);
  EXPECT_NEAR(found.parameters.sliding_friction_coefficient->value, 0.2291, 1e-4);
  EXPECT_LT(*found.parameters.sliding_friction_coefficient->std, 0.005);
  EXPECT_LT(*found.parameters.limiting_static_friction->std, 0.02);
  EXPECT_EQ(found.findings[1].value, found.parameters.sliding_friction_coefficient->value);
}

// Two recordings at different speeds know different sums of Coulomb and viscous friction well.
TEST(CombineWithKnown, SplitsFrictionByTwoSpeedsThatEachAloneDoesNot) {
  const ObjectParameters slow = friction(3.0, 0.1, 0.25, 0.05, 10.0, 6.0, -0.99);
  const ObjectParameters fast = friction(3.0, 0.1, 0.26, 0.06, 9.0, 3.0, -0.98);
  ObjectIdentification found = found_as(fast);
  combine_with_known(slow, found);
  EXPECT_LT(*found.parameters.sliding_friction_coefficient->std, 0.03);
  EXPECT_LT(*found.parameters.viscous_friction->std, 3.0);
  ASSERT_EQ(found.parameters.sources.correlated.size(), 2U);
}

TEST(CombineWithKnown, WidensTheStdByWhatTheTwoDiffer) {
  const ObjectParameters before = friction(3.0, 0.05, 0.25, 0.01, 5.0, 1.0, 0.0);
  ObjectIdentification found = found_as(friction(3.3, 0.05, 0.25, 0.01, 5.0, 1.0, 0.0));
  combine_with_known(before, found);
  EXPECT_NEAR(found.parameters.limiting_static_friction->value, 3.15, 1e-9);
  EXPECT_GT(*found.parameters.limiting_static_friction->std, 0.1);
}

TEST(CombineWithKnown, LetsContradictionsAndGivenValuesBeReplaced) {
  ObjectParameters before = friction(3.0, 0.02, 0.25, 0.01, 5.0, 1.0, 0.0);
  before.sources.given = {"sliding_friction_coefficient", "viscous_friction"};
  ObjectIdentification found = found_as(friction(4.0, 0.02, 0.30, 0.01, 6.0, 1.0, 0.0));
  combine_with_known(before, found);
  EXPECT_EQ(found.parameters.limiting_static_friction->value, 4.0);
  EXPECT_EQ(found.parameters.sliding_friction_coefficient->value, 0.30);
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes[0].find("limiting_static_friction was 3 +- 0.02 before"),
            std::string::npos);
}

// The same data twice are no more information.
TEST(CombineWithKnown, DoesNotCountARecordingTwice) {
  ObjectParameters before = friction(3.0, 0.05, 0.25, 0.01, 5.0, 1.0, 0.0);
  before.sources.recordings = {"0000000000000001", "0000000000000002"};
  ObjectIdentification found = found_as(friction(3.02, 0.05, 0.25, 0.01, 5.0, 1.0, 0.0));
  add_recordings({"0000000000000002"}, found);
  combine_with_known(before, found);
  EXPECT_EQ(found.parameters.limiting_static_friction->value, 3.02);
  EXPECT_EQ(*found.parameters.limiting_static_friction->std, 0.05);
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes[0].find("is from this recording, too"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
