// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

constexpr double kMass = 1.25;  // [kg]
constexpr double kCoefficient = 0.23;
constexpr double kLimit = 3.4;  // [N]

IdentifiableObject body(std::optional<double> weighed_mass) {
  IdentifiableObject object;
  object.name = "body";
  object.mass = weighed_mass;
  return object;
}

/// What a force of `scale` times the true one shows.
ObjectIdentification pushed_object(double scale, double mass_std = 0.02) {
  ObjectIdentification found;
  found.sliding.mass = {.value = scale * kMass, .std = mass_std * kMass, .is_excited = true};
  found.parameters.inertial_mass = ParameterValue{scale * kMass, 0.02 * kMass};
  found.parameters.sliding_friction_coefficient = ParameterValue{scale * kCoefficient, 0.002};
  found.parameters.limiting_static_friction = ParameterValue{scale * kLimit, 0.05};
  found.parameters.sliding_force = {{0.05, scale * 3.5, 0.03}};
  return found;
}

void expect_covered(const ParameterValue& found, double truth) {
  EXPECT_LE(std::abs(found.value - truth), *found.std) << truth;
}

TEST(DoubtForceScale, CoversTheTruthWhetherForceOrMassIsWrong) {
  for (const double scale : {0.5, 0.8, 1.3, 2.0}) {
    // The force is wrong.
    ObjectIdentification found = pushed_object(scale);
    doubt_force_scale(body(kMass), {}, found);
    expect_covered(*found.parameters.limiting_static_friction, kLimit);
    expect_covered(*found.parameters.sliding_friction_coefficient, kCoefficient);
    expect_covered(*found.parameters.inertial_mass, kMass);
    EXPECT_LE(std::abs(found.parameters.sliding_force[0].force - 3.5),
              found.parameters.sliding_force[0].std);
    EXPECT_FALSE(found.notes.empty());
    // The mass is.
    found = pushed_object(1.0);
    found.parameters.sliding_friction_coefficient->value = kCoefficient * scale;
    doubt_force_scale(body(kMass / scale), {}, found);
    expect_covered(*found.parameters.sliding_friction_coefficient, kCoefficient);
  }
}

// Two to four stds of the masses, below what is named: the limit has a std of 1.5 %.
TEST(DoubtForceScale, CoversTheTruthWhereTheMassesDifferByFewStds) {
  for (const double scale : {0.9, 1.1, 1.17}) {
    for (const double mass_std : {0.03, 0.04}) {
      ObjectIdentification found = pushed_object(scale, mass_std);
      doubt_force_scale(body(kMass), {}, found);
      const ParameterValue& limit = *found.parameters.limiting_static_friction;
      EXPECT_LT(std::abs(limit.value - kLimit), 2.5 * *limit.std) << scale << " " << mass_std;
    }
  }
}

TEST(DoubtForceScale, GrowsWithTheDifference) {
  double last = 0.05;
  for (const double scale : {1.05, 1.06, 1.07, 1.08, 1.1, 1.15, 1.3}) {
    ObjectIdentification found = pushed_object(scale);
    doubt_force_scale(body(kMass), {}, found);
    const double std = *found.parameters.limiting_static_friction->std;
    EXPECT_GT(std, last) << scale;
    EXPECT_LT(std, last + 0.6) << scale;  // no step
    last = std;
  }
}

TEST(DoubtForceScale, LeavesStdsWhereTheMassesAgreeOrOneIsNotKnown) {
  ObjectIdentification found = pushed_object(1.03);
  doubt_force_scale(body(kMass), {}, found);
  EXPECT_EQ(found.parameters.limiting_static_friction->std, 0.05);
  found = pushed_object(1.5);
  doubt_force_scale(body({}), {}, found);
  EXPECT_EQ(found.parameters.limiting_static_friction->std, 0.05);
  EXPECT_TRUE(found.notes.empty());
}

}  // namespace
}  // namespace pcavr
