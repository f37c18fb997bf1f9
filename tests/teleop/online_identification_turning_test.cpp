// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Online identification of how a tracked object turns, and of how the tip slips along it.
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/friction/point_push.hpp"
#include "pcavr/physics/turning/turning.hpp"

#include "support/meshes.hpp"
#include "teleop/learned_friction.hpp"
#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

constexpr double kTip = 0.01;           // [m] radius
constexpr double kFriction = 5.0;       // [N] of the object on its support
constexpr double kRadius = 0.025;       // [m] of that friction: feet near the centre of mass
constexpr double kEvenRadius = 0.0383;  // [m] of a square of 0.1 m under even pressure
constexpr double kToolFriction = 0.2;
constexpr double kStep = 0.002;  // [s]
constexpr double kSpeed = 0.03;  // [m/s]

CadModel block() {
  return make_cad_model(test::box_mesh({0.1F, 0.1F, 0.05F}), "block", "test").value();
}

/// Quasi-static push along +y on the face at y = -50 mm, `beside` the centre of mass, of a block
/// that stands on feet near its centre; the tip may slip.
struct OffCentrePush {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;
  std::vector<TrackedPose> tracked;

  OffCentrePush(double beside, double lateral, const LimitSurface& surface, std::uint64_t seed) {
    Random random(seed);
    Eigen::Vector3d pose = Eigen::Vector3d::Zero();  // x, y, heading
    Eigen::Vector2d touched(beside, -0.05);          // in the block's axes
    for (double at = -0.5; at < 2.3; at += kStep) {
      const bool is_pushed = at >= 0.0 && at < 2.0;
      Eigen::Vector3d load = Eigen::Vector3d::Zero();
      const Eigen::Rotation2Dd R(pose.z());
      if (is_pushed) {
        const Eigen::Vector2d along = R.inverse() * Eigen::Vector2d(lateral, 1.0).normalized();
        const PushMotion motion = push_at_point(
            surface, {touched, Eigen::Vector2d::UnitY(), kToolFriction, kSpeed * along});
        // The contact is loaded within a quarter of a second, before the block moves.
        const double share = std::min(1.0, at / 0.25);
        load.head<2>() = share * (R * motion.wrench.head<2>());
        if (share >= 1.0) {
          const Eigen::Vector2d of_point = velocity_of(touched, motion.twist);
          touched += kStep * (kSpeed * along - of_point);
          pose.head<2>() += kStep * (R * motion.twist.head<2>());
          pose.z() += kStep * motion.twist.z();
        }
      }
      const Eigen::Vector2d centre =
          pose.head<2>() + R * (touched - Eigen::Vector2d(0.0, kTip - 1e-4 * load.norm()));
      const double back = at < 0.0 ? kSpeed * at : at >= 2.0 ? -kSpeed * (at - 2.0) : 0.0;
      const auto noise = [&](double std) {
        return Eigen::Vector3d(std * random.normal(), std * random.normal(), std * random.normal());
      };
      t.push_back(at);
      force.push_back(load + noise(0.05));
      tip.push_back(Eigen::Vector3d(centre.x(), centre.y() + back, 0.0) + noise(2e-5));
      if (std::lround((at + 0.5) / kStep) % 15 != 0) continue;
      const Eigen::Quaterniond turned(Eigen::AngleAxisd(pose.z(), Eigen::Vector3d::UnitZ()));
      tracked.push_back(
          {at, Pose(turned, Eigen::Vector3d(pose.x(), pose.y(), 0.0) + noise(1e-4)), 2e-4, 1e-3});
    }
  }
};

LimitSurface on_feet() { return ellipsoid_surface(kFriction, kFriction * kRadius); }

/// What is known after pushes at these places beside the centre [m].
OnlineIdentification learnt_from(const std::vector<double>& places, double lateral, bool is_tracked,
                                 const LimitSurface& surface_of_friction = on_feet()) {
  ObjectParameters given;
  given.mass = ParameterValue{1.5};
  OnlineIdentification knowledge = knowledge_of_box(given);
  double start = 0.0;
  std::uint64_t seed = 1;
  for (const double beside : places) {
    OffCentrePush push(beside, lateral, surface_of_friction, seed++);
    for (double& t : push.t) t += start;
    for (TrackedPose& pose : push.tracked) pose.t += start;
    ContactSamples record{push.t, push.force, push.t, push.tip, {}, start, {true, true}};
    if (is_tracked) record.tracked = push.tracked;
    learn_with_friction(knowledge, record);
    start += 10.0;
  }
  return knowledge;
}

TEST(OnlineIdentificationTurning, LearnsTheFrictionRadiusOfAnObjectOnFeet) {
  const ObjectParameters known = learnt_from({0.02, -0.025, 0.03, -0.015}, 0.0, true).known();
  ASSERT_TRUE(known.friction_radius);
  // Uniform pressure on its face: 38 mm.
  EXPECT_NEAR(known.friction_radius->value, kRadius, 0.1 * kRadius);
  EXPECT_TRUE(known.limit_surface);
}

TEST(OnlineIdentificationTurning, KeepsTheSupportsRadiusAfterFewPushes) {
  EXPECT_FALSE(learnt_from({0.02, -0.025}, 0.0, true).known().friction_radius);
}

TEST(OnlineIdentificationTurning, KeepsTheSupportsRadiusWhereThePushesDoNotContradictIt) {
  LimitSurface even = surface_of_support(block(), Pose(), kEvenRadius);
  even.force = kFriction;
  EXPECT_FALSE(learnt_from({0.02, -0.025, 0.03}, 0.0, true, even).known().friction_radius);
}

TEST(OnlineIdentificationTurning, NeedsTracking) {
  const ObjectParameters known = learnt_from({0.02, -0.025, 0.03, -0.015}, 0.8, false).known();
  EXPECT_FALSE(known.friction_radius);
  EXPECT_FALSE(known.tool_friction_coefficient);
}

TEST(OnlineIdentificationTurning, LearnsTheTipsFrictionWhereItSlips) {
  const ObjectParameters known = learnt_from({0.0, 0.005}, 0.8, true).known();
  ASSERT_TRUE(known.tool_friction_coefficient);
  EXPECT_NEAR(known.tool_friction_coefficient->value, kToolFriction, 0.1 * kToolFriction);
}

TEST(OnlineIdentificationTurning, WithdrawsTheTipsFrictionWhereTheForceMayBeTurned) {
  OnlineIdentification knowledge = learnt_from({0.0, 0.005}, 0.8, true);
  ASSERT_TRUE(knowledge.known().tool_friction_coefficient);
  EXPECT_FALSE(knowledge.next_search());  // it would find the same
  constexpr double kTurn = 0.5;           // [rad]
  knowledge.set_suspected_turn(kTurn);
  const auto search = knowledge.next_search();
  ASSERT_TRUE(search);
  const ObjectIdentifier::Result found = search->result();
  knowledge.accept(found);
  EXPECT_FALSE(knowledge.known().tool_friction_coefficient);
  // The friction that stays is as uncertain as a turn leaves it.
  const auto& coefficient = knowledge.known().sliding_friction_coefficient;
  ASSERT_TRUE(coefficient && coefficient->std);
  EXPECT_GT(*coefficient->std, (1.0 / std::cos(kTurn) - 1.0) * coefficient->value);
}

TEST(SentParameters, ContainALimitSurfaceThatHasChanged) {
  BodyPhysics physics;
  physics.friction.mass = 1.5;
  physics.friction.limiting_force = 6.0;
  physics.friction.coulomb_force = 5.0;
  physics.contact.stiffness = 1e4;
  physics.friction_radius = 0.03;
  physics.limit_surface = ellipsoid_surface(5.0, 5.0 * 0.03);
  const ObjectParameters before = sent_parameters(physics, 9.8);
  EXPECT_FALSE(difference(before, before, nullptr, {}).has_friction);
  // One whose axes differ, of the same friction radius.
  physics.limit_surface = ellipsoid_surface(5.0, 5.0 * 0.03, {0.01, 0.0});
  const ParameterDifference changed =
      difference(sent_parameters(physics, 9.8), before, nullptr, {});
  EXPECT_TRUE(changed.has_friction);
  EXPECT_TRUE(changed.friction.limit_surface);
}

}  // namespace
}  // namespace pcavr
