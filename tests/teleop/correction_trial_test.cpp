// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/correction_trial.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/prediction/body_physics.hpp"

#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

/// [m] Displayed std of the corrected pose of a box that is pushed for 0.4 s along x by a tip of
/// `speed` [m/s] that begins at `gap` [m] before its face.
double displayed_std(double speed, double gap) {
  constexpr double kHalf = 0.05;
  TeleopInput world;
  world.objects.push_back({"box",
                           box_model("box", Eigen::Vector3d::Constant(kHalf)),
                           Pose::from_translation({0.0, 0.0, kHalf}),
                           {},
                           {}});
  const TeleopOptions options;
  TeleopObject& box = world.objects[0];
  box.parameters.mass = ParameterValue{1.0};
  const BodyPhysics physics = complete_physics(box.parameters, box.model, box.T_base_object,
                                               options.gravity(), options.unknown_objects)
                                  .physics;
  CorrectionTrial trial(world, {physics}, options);
  TriedCorrection tried;
  tried.until = 0.4;
  tried.poses = {planar_pose_of(box.T_base_object)};
  tried.physics = physics;
  tried.position_std = 1e-4;
  tried.rotation_std = 1e-3;
  tried.p_base_tip = [&](double t) {
    return Eigen::Vector3d(-kHalf - world.tool_radius - gap + speed * t, 0.0, kHalf);
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

}  // namespace
}  // namespace pcavr
