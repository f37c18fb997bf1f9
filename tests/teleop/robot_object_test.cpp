// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/robot_object.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr double kSlowInterval = 0.01;        // [s] of tip and force
constexpr double kSlowFrameInterval = 0.033;  // [s]
constexpr double kSlowHalf = 0.05;            // [m]
constexpr double kTipRadius = 0.01;           // [m]
constexpr double kTipSpeed = 0.0025;          // [m/s]
constexpr double kTurnRate = 0.02;            // [rad/s]

/// A slow push along x of a box that turns as it slides: F = 20600 d^1.5, 4 N while it slides.
struct SlowPush {
  double tip = -kSlowHalf - kTipRadius - 0.002, object = 0.0, yaw = 0.0, force = 0.0;

  void advance() {
    const double max_depth = std::pow(4.0 / 20600.0, 1.0 / 1.5);
    tip += kTipSpeed * kSlowInterval;
    const double depth = std::max(tip + kTipRadius - (object - kSlowHalf), 0.0);
    if (depth > max_depth) {
      object += depth - max_depth;
      yaw += kTurnRate * kSlowInterval;
    }
    force = 20600.0 * std::pow(std::min(depth, max_depth), 1.5);
  }
  [[nodiscard]] Pose T_base_object() const {
    return pose_at({object, 0.0, yaw}, Pose::from_translation({0.0, 0.0, 0.03}));
  }
};

TeleopObject slow_box() {
  return {"box",
          box_model("box", {kSlowHalf, kSlowHalf, 0.03}),
          Pose::from_translation({0.0, 0.0, 0.03}),
          {},
          {}};
}

/// The object as the robot's site keeps it; `box` must outlive it.
RobotObject object_of(const TeleopObject& box) {
  const TeleopOptions options;
  const BodyPhysics physics = complete_physics(box.parameters, box.model, box.T_base_object,
                                               options.gravity(), options.unknown_objects)
                                  .physics;
  const SensorProperties sensors{.interval = kSlowInterval, .correlated = 2.0, .enter_force = 0.4};
  return {box, physics, options, sensors, kTipRadius, 0.0};
}

TEST(RobotObject, TakesTheNewestFrameWhenASlowSlideIsNoticed) {
  TeleopObject box = slow_box();
  box.parameters.mass = ParameterValue{1.5};
  RobotObject object = object_of(box);
  SlowPush push;
  double next_frame = 0.0;
  for (double t = 0.0; t < 4.0; t += kSlowInterval) {
    push.advance();
    if (t >= next_frame) {
      object.pose().add_tracked({t, push.T_base_object(), 0.001, 0.010});
      next_frame += kSlowFrameInterval;
    }
    object.pose().update_tracking(t, 0.0);
    const Eigen::Vector3d p_base_tip(push.tip, 0.0, 0.03);
    const Eigen::Vector3d force_base(push.force, 0.0, 0.0);
    object.monitor().step({t, p_base_tip, force_base, Eigen::Vector3d::UnitX(), true}, std::nullopt,
                          0.0);
    const PoseEstimate estimate = object.estimate_pose({t, p_base_tip, force_base}, {});
    if (object.monitor().phase() != MotionPhase::sliding) continue;
    EXPECT_GT(push.yaw, 0.1 * kTurnRate) << "noticed late";
    EXPECT_NEAR(heading_of(estimate.T_base_object), push.yaw, 1.1 * kSlowFrameInterval * kTurnRate);
    return;
  }
  FAIL() << "no slide";
}

struct RestingTip {
  double correlation = 0.999;    ///< of the law's stiffness and exponent
  double exponent_std = 0.045;   ///< of the law
  double tracked_offset = 3e-4;  ///< [m]
  double tracked_std = 2e-3;     ///< [m] as stated
};

/// x [m] at which a box at the origin is estimated while a tip rests against it with 8 N.
double estimated_x(const RestingTip& given) {
  constexpr double kFoamStiffness = 20600.0, kFoamExponent = 1.5;
  constexpr double kFoamStiffnessStd = 3090.0;
  constexpr double kRestingForce = 8.0;
  TeleopObject box = slow_box();
  box.parameters.mass = ParameterValue{3.0};
  box.parameters.limiting_static_friction = ParameterValue{20.0};
  box.parameters.contact_stiffness = {kFoamStiffness, kFoamStiffnessStd};
  box.parameters.contact_exponent = {kFoamExponent, given.exponent_std};
  const double mixed = given.correlation * kFoamStiffnessStd * given.exponent_std;
  Eigen::Matrix2d covariance;
  covariance << kFoamStiffnessStd * kFoamStiffnessStd, mixed, mixed,
      given.exponent_std * given.exponent_std;
  set_correlation({"contact.stiffness", "contact.exponent"}, covariance, box.parameters.sources);
  RobotObject object = object_of(box);
  const double max_depth = std::pow(kRestingForce / kFoamStiffness, 1.0 / kFoamExponent);
  double depth = -0.002, next_frame = 0.0, x = 0.0;
  for (double t = 0.0; t < 4.0; t += kSlowInterval) {
    depth = std::min(depth + kTipSpeed * kSlowInterval, max_depth);
    if (t >= next_frame) {
      object.pose().add_tracked(
          {t, Pose::from_translation({given.tracked_offset, 0.0, 0.03}), given.tracked_std, 0.010});
      next_frame += kSlowFrameInterval;
    }
    object.pose().update_tracking(t, 0.0);
    const Eigen::Vector3d p_base_tip(depth - kSlowHalf - kTipRadius, 0.0, 0.03);
    const Eigen::Vector3d force_base(kFoamStiffness * std::pow(std::max(depth, 0.0), kFoamExponent),
                                     0.0, 0.0);
    object.monitor().step({t, p_base_tip, force_base, Eigen::Vector3d::UnitX(), true}, std::nullopt,
                          0.0);
    x = object.estimate_pose({t, p_base_tip, force_base}, {}).T_base_object.translation().x();
  }
  return x;
}

TEST(RobotObject, IsWhereTheTipMeetsItWhereTheLawsPenetrationIsKnown) {
  EXPECT_LT(std::abs(estimated_x({})), 1.5e-4);
  // Stiffness and exponent that are known one by one only say little of the penetration.
  EXPECT_GT(estimated_x({.correlation = 0.0}), 2e-4);
}

// 0.1 mm is several newtons on a stiff face: too little for a good tracker to show, and too little
// to be an offset of the surface. Here the law's stds cancel.
TEST(RobotObject, IsWhereTheTipMeetsItWithinTheTrackersStd) {
  const RestingTip fine{.exponent_std = 0.0286, .tracked_offset = 1e-4, .tracked_std = 2e-4};
  EXPECT_LT(std::abs(estimated_x(fine)), 3e-5);
}

/// Frames of an untouched box at `x` [m] with noise of 0.2 mm along each axis, of which the tracker
/// states `position_std` [m].
class RestingBox {
 public:
  explicit RestingBox(double position_std) : position_std_(position_std) {}

  /// The object's estimated position after `frames` more of them, the first of which is `outlier`
  /// [m] off along x.
  Eigen::Vector3d estimate_after(int frames, double x, double outlier = 0.0) {
    for (int i = 0; i < frames; ++i, t_ += kSlowFrameInterval) {
      const Eigen::Vector3d noise(random_.normal(), random_.normal(), random_.normal());
      const Eigen::Vector3d shift(x + (i == 0 ? outlier : 0.0), 0.0, 0.03);
      object_.pose().add_tracked(
          {t_, Pose::from_translation(shift + 2e-4 * noise), position_std_, 0.002});
      object_.pose().update_tracking(t_, 0.0);
    }
    return object_.estimate_pose({t_, {-1.0, 0.0, 0.03}, Eigen::Vector3d::Zero()}, {})
               .T_base_object.translation() -
           Eigen::Vector3d(0.0, 0.0, 0.03);
  }
  [[nodiscard]] const TrackedPose& latest() const { return object_.pose().latest(); }

 private:
  TeleopObject box_ = slow_box();
  RobotObject object_ = object_of(box_);
  Random random_{5};
  double position_std_, t_ = 0.0;
};

TEST(RobotObject, AveragesAtRestWhatIsNoisierThanTheTrackerStates) {
  RestingBox box(2e-4);
  box.estimate_after(60, 0.0);
  double squares = 0.0;
  constexpr int kTimes = 200;
  for (int i = 0; i < kTimes; ++i) squares += box.estimate_after(1, 0.0).squaredNorm();
  EXPECT_LT(std::sqrt(squares / (3.0 * kTimes)), 1e-4);
}

TEST(RobotObject, MeasuresTheTrackersNoise) {
  RestingBox box(2e-4);
  box.estimate_after(100, 0.0);
  // Half of a frame's: an average of thirty.
  EXPECT_NEAR(box.latest().position_std, 0.5 * std::sqrt(3.0) * 2e-4, 4e-5);
}

TEST(RobotObject, IsNotWhereASingleFrameShowsItAtRest) {
  RestingBox box(3.5e-4);
  box.estimate_after(60, 0.0);
  EXPECT_LT(box.estimate_after(1, 0.0, 0.004).norm(), 2e-4);
  EXPECT_LT(box.estimate_after(1, 0.0).norm(), 2e-4);
}

TEST(RobotObject, IsWhereTwoFramesShowThatItWasMoved) {
  RestingBox box(3.5e-4);
  box.estimate_after(60, 0.0);
  EXPECT_NEAR(box.estimate_after(2, 0.004).x(), 0.004, 8e-4);
}

TEST(RobotObject, KeepsTheStribeckSpeedOfTheGivenParameters) {
  TeleopObject box = slow_box();
  const auto speed_with = [&](const ObjectParameters& learned) {
    return object_of(box).physics_with(learned).stribeck_speed;
  };
  ObjectParameters known;
  known.limiting_static_friction = {9.57, {}};
  known.sliding_friction_coefficient = {0.29, {}};
  known.contact_stiffness = {8000.0, {}};
  known.contact_damping = {30.0, {}};
  EXPECT_EQ(speed_with(known), 0.0);
  box.parameters = known;
  EXPECT_EQ(speed_with(known), TeleopOptions().unknown_objects.stribeck_speed);
}

}  // namespace
}  // namespace pcavr
