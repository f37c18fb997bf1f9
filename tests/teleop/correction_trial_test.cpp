// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/correction_trial.hpp"

#include <cmath>
#include <future>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "pcavr/physics/prediction/body_physics.hpp"

#include "teleop/plant_input.hpp"
#include "teleoperation/teleop/pending_trial.hpp"

namespace pcavr {
namespace {

constexpr double kHalfBox = 0.05;

/// A box of 1 kg.
TeleopInput one_box_input() {
  TeleopInput world;
  world.objects.push_back({"box",
                           box_model("box", Eigen::Vector3d::Constant(kHalfBox)),
                           Pose::from_translation({0.0, 0.0, kHalfBox}),
                           {},
                           {}});
  world.objects[0].parameters.mass = ParameterValue{1.0};
  return world;
}

BodyPhysics physics_of(const TeleopObject& object, const TeleopOptions& options) {
  return complete_physics(object.parameters, object.model, object.T_base_object, options.gravity(),
                          options.unknown_objects)
      .physics;
}

/// [m] Displayed std of the corrected pose of a box that is pushed for 0.4 s along x by a tip of
/// `speed` [m/s] that begins at `gap` [m] before its face.
double displayed_std(double speed, double gap) {
  const TeleopInput world = one_box_input();
  const TeleopOptions options;
  const TeleopObject& box = world.objects[0];
  const BodyPhysics physics = physics_of(box, options);
  CorrectionTrial trial(world, {physics}, options);
  TriedCorrection tried;
  tried.until = 0.4;
  tried.poses = {planar_pose_of(box.T_base_object)};
  tried.physics = physics;
  tried.position_std = 1e-4;
  tried.rotation_std = 1e-3;
  tried.p_base_tip = [&](double t) {
    return Eigen::Vector3d(-kHalfBox - world.tool_radius - gap + speed * t, 0.0, kHalfBox);
  };
  return trial.displayed_std(tried).value();
}

TEST(CorrectionTrial, KeepsTheNoiseOfABodyThatIsNotPushed) {
  // A rotation counts at 70 mm.
  EXPECT_NEAR(displayed_std(0.0, 0.01), std::hypot(1e-4, 0.07 * 1e-3), 1e-9);
}

TEST(CorrectionTrial, FindsThatAPushChangesTheNoiseOnlyALittleInTheMiddleOfAFace) {
  const double pushed = displayed_std(0.03, 0.0);
  EXPECT_GT(pushed, 5e-5);
  EXPECT_LT(pushed, 5e-4);
  EXPECT_NE(pushed, displayed_std(0.0, 0.01));
}

/// A push of the box at 20 mm/s for a second, whose face's force and place are those of a body
/// that breaks loose at `limit` [N] and slides at `friction` [N] by a linear contact law.
struct Push {
  TriedContact tried;

  Push(double stiffness, double limit, double friction, double tool_radius) {
    constexpr double kSpeed = 0.02;
    Contact& contact = tried.contact;
    double moved = 0.0;
    for (int i = 1; i <= 1000; ++i) {
      const double tip = kSpeed * 1e-3 * i;
      const bool has_slid = moved > 0.0;
      if (has_slid || stiffness * tip > limit) moved = tip - friction / stiffness;
      contact.t.push_back(1e-3 * i);
      contact.force.push_back(stiffness * (tip - moved));
      if (i % 33 != 0) continue;
      // It turns more and more, as a push at one point lets it: that is no matter of parameters.
      const Eigen::Quaterniond turned(Eigen::AngleAxisd(2.0 * moved, Eigen::Vector3d::UnitZ()));
      contact.tracked.push_back(
          {1e-3 * i, Pose(turned, {moved, 0.3 * moved, kHalfBox}), 1e-4, 1e-3});
    }
    contact.object = 0;
    contact.end = 1.0;
    contact.direction_base = Eigen::Vector3d::UnitX();
    contact.T_base_object = Pose::from_translation({0.0, 0.0, kHalfBox});
    tried.force_resolution = 0.2;
    tried.p_base_tip = [tool_radius](double now) {
      return Eigen::Vector3d(-kHalfBox - tool_radius + kSpeed * now, 0.0, kHalfBox);
    };
  }
};

TEST(CorrectionTrial, FindsWhichParametersAContactAgreesWith) {
  TeleopInput world = one_box_input();
  const TeleopOptions options;
  ObjectParameters& known = world.objects[0].parameters;
  known.mass = ParameterValue{0.5};
  known.contact_stiffness = ParameterValue{4000.0};
  known.contact_damping = ParameterValue{20.0};
  known.contact_exponent = ParameterValue{1.0};
  known.limiting_static_friction = ParameterValue{4.2};
  known.sliding_friction_coefficient = ParameterValue{4.0 / (0.5 * options.gravity())};
  known.viscous_friction = ParameterValue{0.0};
  const BodyPhysics right = physics_of(world.objects[0], options);
  CorrectionTrial trial(world, {right}, options);
  const Push push(4000.0, 4.2, 4.0, world.tool_radius);
  const double least = trial.error_of(push.tried, right).value();
  EXPECT_LT(least, 1.0);
  BodyPhysics wrong = right;
  wrong.friction.coulomb_force *= 0.7;
  EXPECT_GT(trial.error_of(push.tried, wrong), 2.0 * least);
  wrong = right;
  wrong.contact.stiffness *= 0.3;
  EXPECT_GT(trial.error_of(push.tried, wrong), 2.0 * least);
  wrong = right;
  wrong.friction.limiting_force *= 3.0;
  EXPECT_GT(trial.error_of(push.tried, wrong), 2.0 * least);
}

// A pose whose noise exceeds the error, and parameters by which a contact is predicted worse.
TEST(PendingTrial, RejectsOnAThreadOrNotFromAFixedTimeOn) {
  TeleopInput world = one_box_input();
  const TeleopOptions options;
  const BodyPhysics right = physics_of(world.objects[0], options);
  BodyPhysics wrong = right;
  wrong.contact.stiffness *= 0.1;
  const Push push(right.contact.stiffness, 4.2, 4.0, world.tool_radius);
  CorrectionTrial trial(world, {right}, options);
  CorrectionProposal proposal;
  TriedCorrection& tried = proposal.pose.emplace();
  tried.until = 0.4;
  tried.poses = {planar_pose_of(world.objects[0].T_base_object)};
  tried.physics = right;
  tried.position_std = 1e-3;
  tried.p_base_tip = [](double) { return Eigen::Vector3d(1.0, 0.0, 1.0); };
  for (const std::launch policy : {std::launch::async, std::launch::deferred}) {
    for (const bool is_worse : {true, false}) {
      proposal.pose_error = is_worse ? 5e-4 : 5e-3;
      proposal.contacts = {push.tried};
      proposal.contacts[0].before = is_worse ? right : wrong;
      proposal.contacts[0].after = is_worse ? wrong : right;
      CorrectionMessage correction;
      correction.pose = PlanarPose{};
      correction.twist = Eigen::Vector3d::Zero();
      correction.parameters.mass = ParameterValue{1.0};
      PendingTrial pending({policy}, 2.0, trial, std::move(correction), proposal);
      EXPECT_FALSE(pending.is_due(2.004));
      EXPECT_FALSE(pending.would_wait(2.004));
      EXPECT_TRUE(pending.is_due(2.0051));
      const CorrectionMessage left = pending.take().value();
      EXPECT_EQ(left.pose.has_value(), !is_worse);
      EXPECT_EQ(left.twist.has_value(), !is_worse);
      EXPECT_EQ(left.parameters.mass.has_value(), !is_worse);
    }
  }
}

TEST(CorrectionTrial, HasNoErrorOfAContactInWhichTheObjectWasNotSeen) {
  const TeleopInput world = one_box_input();
  const TeleopOptions options;
  const BodyPhysics physics = physics_of(world.objects[0], options);
  CorrectionTrial trial(world, {physics}, options);
  EXPECT_FALSE(trial.error_of({}, physics));
}

}  // namespace
}  // namespace pcavr
