// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/prediction/body_physics.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/physics/friction/patch.hpp"

#include "prediction/worlds.hpp"

namespace pcavr {
namespace {

constexpr double kGravity = 9.80665;

CompletedPhysics complete(const ObjectParameters& known) {
  return complete_physics(known, test::box_model(test::kBoxSides), test::standing_at(0.0, 0.0));
}

TEST(CompletePhysics, ListsAllDefaults) {
  const CompletedPhysics completed = complete({});
  EXPECT_EQ(completed.assumed,
            (std::vector<std::string>{"mass", "sliding_friction_coefficient",
                                      "limiting_static_friction", "viscous_friction",
                                      "contact_exponent", "contact_stiffness", "contact_damping",
                                      "tool_friction_coefficient", "friction_radius"}));
  const FrictionParameters& friction = completed.physics.friction;
  EXPECT_NEAR(friction.mass, 700.0 * 0.175 * 0.175 * 0.125, 1e-4);
  EXPECT_NEAR(friction.coulomb_force, 0.5 * friction.mass * kGravity, 1e-9);
  EXPECT_NEAR(friction.limiting_force, 1.1 * friction.coulomb_force, 1e-9);
  // The breakaway force causes a penetration of a millimetre.
  const HuntCrossley& contact = completed.physics.contact;
  EXPECT_NEAR(contact.stiffness * std::pow(0.001, contact.exponent), friction.limiting_force, 1e-9);
}

TEST(CompletePhysics, KeepsKnownParameters) {
  ObjectParameters known;
  known.mass = {3.0, {}};
  known.limiting_static_friction = {9.57, 0.861};
  known.sliding_friction_coefficient = {0.29, {}};
  known.viscous_friction = {2.0, {}};
  known.contact_stiffness = {8000.0, {}};
  known.contact_damping = {30.0, {}};
  known.contact_exponent = {1.3, {}};
  known.friction_radius = {0.05, {}};
  known.tool_friction_coefficient = {0.2, {}};
  const CompletedPhysics completed = complete(known);
  EXPECT_TRUE(completed.assumed.empty());
  const BodyPhysics& physics = completed.physics;
  EXPECT_EQ(physics.friction.mass, 3.0);
  EXPECT_EQ(physics.friction.limiting_force, 9.57);
  EXPECT_EQ(physics.friction.limiting_force_std, 0.861);
  EXPECT_NEAR(physics.friction.coulomb_force, 0.29 * 3.0 * kGravity, 1e-12);
  EXPECT_EQ(physics.contact.exponent, 1.3);
  EXPECT_EQ(physics.friction_radius, 0.05);
}

TEST(CompletePhysics, AssumesTheStribeckSpeedOfIdentifiedObjectsOnly) {
  ObjectParameters known;
  known.limiting_static_friction = {9.57, {}};
  known.sliding_friction_coefficient = {0.29, {}};
  known.contact_stiffness = {8000.0, {}};
  EXPECT_EQ(complete(known).physics.stribeck_speed, 0.0);
  known.contact_damping = {30.0, {}};
  EXPECT_EQ(complete(known).physics.stribeck_speed, PhysicsDefaults().stribeck_speed);
}

TEST(CompletePhysics, DerivesOneFrictionFromTheOther) {
  ObjectParameters known;
  known.mass = {3.0, {}};
  known.limiting_static_friction = {11.0, {}};
  EXPECT_NEAR(complete(known).physics.friction.coulomb_force, 10.0, 1e-12);
  known.limiting_static_friction.reset();
  known.sliding_friction_coefficient = {0.2, {}};
  EXPECT_NEAR(complete(known).physics.friction.limiting_force, 1.1 * 0.2 * 3.0 * kGravity, 1e-12);
  // Both, but no mass: the mass that agrees with them.
  known.mass.reset();
  known.limiting_static_friction = {11.0, {}};
  EXPECT_NEAR(complete(known).physics.friction.mass, 10.0 / (0.2 * kGravity), 1e-12);
}

TEST(CompletePhysics, TakesTheSlidingForceWhereItsSplitIsNotKnown) {
  ObjectParameters known;
  known.mass = {0.351, {}};
  known.sliding_force = {{0.056, 0.96, 0.2}, {0.218, 2.34, 1.3}};
  const CompletedPhysics completed = complete(known);
  EXPECT_NEAR(completed.physics.friction.coulomb_force, 0.96, 1e-12);
  EXPECT_EQ(completed.physics.friction.viscous, 0.0);
  EXPECT_NE(
      std::find(completed.assumed.begin(), completed.assumed.end(), "sliding_friction_coefficient"),
      completed.assumed.end());
  known.limiting_static_friction = {0.9, {}};  // friction of a slide is not above it
  EXPECT_NEAR(complete(known).physics.friction.coulomb_force, 0.9, 1e-12);
  known.sliding_friction_coefficient = {0.2, {}};
  EXPECT_NEAR(complete(known).physics.friction.coulomb_force, 0.2 * 0.351 * kGravity, 1e-12);
}

TEST(CompletePhysics, TakesTheFrictionRadiusFromTheLowestFace) {
  const double expected = mean_radius_of_rectangle(0.175, 0.175);
  EXPECT_NEAR(complete({}).physics.friction_radius, expected, 1e-6);
  // Standing on its narrow side.
  const Pose on_its_side(
      Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX())),
      {0.3, 0.1, 0.0875});
  const CompletedPhysics narrow =
      complete_physics({}, test::box_model(test::kBoxSides), on_its_side);
  EXPECT_NEAR(narrow.physics.friction_radius, mean_radius_of_rectangle(0.175, 0.125), 1e-6);
  // The friction radius on an edge is still positive.
  const Pose on_edge(
      Eigen::Quaterniond(Eigen::AngleAxisd(0.25 * std::numbers::pi, Eigen::Vector3d::UnitX())),
      {0.3, 0.1, 0.1});
  const double on_line =
      complete_physics({}, test::box_model(test::kBoxSides), on_edge).physics.friction_radius;
  EXPECT_GT(on_line, 0.01);
  EXPECT_LT(on_line, 0.1);
}

TEST(CompletePhysics, RefusesNumbersThatAreNotPhysical) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    ObjectParameters known;
    known.mass = {bad, {}};
    EXPECT_THROW(static_cast<void>(complete(known)), ContractError) << bad;
    known = {};
    known.sliding_friction_coefficient = {bad, {}};
    EXPECT_THROW(static_cast<void>(complete(known)), ContractError) << bad;
    known = {};
    known.contact_stiffness = {bad, {}};
    EXPECT_THROW(static_cast<void>(complete(known)), ContractError) << bad;
    known = {};
    known.limiting_static_friction = {9.0, bad};
    EXPECT_THROW(static_cast<void>(complete(known)), ContractError) << bad;
  }
  ObjectParameters known;
  known.contact_exponent = {0.9, {}};
  EXPECT_THROW(static_cast<void>(complete(known)), ContractError);
}

TEST(Heading, IsThatOfTheProjectedXAxisOrOfTheYAxisWhereXIsSteep) {
  EXPECT_NEAR(heading_of(test::standing_at(1.0, 2.0, 0.7)), 0.7, 1e-12);
  const auto tilted = [](double angle) {
    return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitY())),
                Eigen::Vector3d::Zero());
  };
  const double degree = std::numbers::pi / 180.0;
  EXPECT_NEAR(heading_of(tilted(59.0 * degree)), 0.7, 1e-12);
  EXPECT_NEAR(heading_of(tilted(61.0 * degree)), 0.7 + 0.5 * std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace pcavr
