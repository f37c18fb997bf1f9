// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

constexpr double kTurn = 30.0 * std::numbers::pi / 180.0;

ObjectIdentification pushed_object() {
  ObjectIdentification found;
  found.parameters.sliding_friction_coefficient = ParameterValue{0.20, 0.005};
  found.parameters.tool_friction_coefficient = ParameterValue{0.96, 0.05};
  found.parameters.sources.pushes["tool_friction_coefficient"] = 3;
  found.tool_friction_contacts = 3;
  found.friction.is_valid = true;
  found.parameters.sliding_force = {{.speed = 0.03, .force = 2.0, .std = 0.05}};
  return found;
}

TEST(DoubtForceDirection, WithholdsFrictionAtTheTipThatATurnedSensorLooksLike) {
  ObjectIdentification found = pushed_object();
  ObjectParameters known;
  doubt_force_direction(kTurn, known, found);
  EXPECT_FALSE(found.parameters.tool_friction_coefficient);
  EXPECT_EQ(found.tool_friction_contacts, 0);
  EXPECT_TRUE(found.parameters.sources.pushes.empty());
  ASSERT_FALSE(found.notes.empty());
  EXPECT_NE(found.notes.front().find("by up to 30 degrees"), std::string::npos)
      << found.notes.front();

  found = pushed_object();
  known.tool_friction_coefficient = ParameterValue{0.25, 0.02};
  doubt_force_direction(kTurn, known, found);
  ASSERT_TRUE(found.parameters.tool_friction_coefficient);
  EXPECT_EQ(found.parameters.tool_friction_coefficient->value, 0.25);
}

TEST(DoubtForceDirection, CoversWhatTheTurnTakesFromFriction) {
  ObjectIdentification found = pushed_object();
  doubt_force_direction(kTurn, {}, found);
  const ParameterValue friction = *found.parameters.sliding_friction_coefficient;
  const double turned_back = friction.value / std::cos(kTurn);
  EXPECT_EQ(friction.value, 0.20);
  EXPECT_LE(std::abs(turned_back - friction.value), *friction.std);
  const SlidingForce& sliding = found.parameters.sliding_force.at(0);
  EXPECT_LE(sliding.force / std::cos(kTurn) - sliding.force, sliding.std);
}

TEST(DoubtForceDirection, LeavesWhatWasKnownBeforeAndWhatNoTurnIsSuspectedOf) {
  ObjectIdentification found = pushed_object();
  doubt_force_direction(0.0, {}, found);
  EXPECT_EQ(found.parameters.tool_friction_coefficient->value, 0.96);
  EXPECT_EQ(found.parameters.sliding_friction_coefficient->std, 0.005);
  EXPECT_TRUE(found.notes.empty());

  const ObjectParameters known = found.parameters;
  doubt_force_direction(kTurn, known, found);
  EXPECT_EQ(found.parameters.sliding_friction_coefficient->std, 0.005);
}

}  // namespace
}  // namespace pcavr
