// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/hand_eye.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "calibration/random_rig.hpp"
#include "support/std_coverage.hpp"

namespace pcavr {
namespace {

const HandEyeNoise kNoNoise{};

TEST(CalibrateHandEye, RecoversACameraOnTheArmAndBesideItWithoutNoise) {
  for (const CameraMount mount : {CameraMount::arm, CameraMount::base}) {
    const RandomRig rig(7, {.mount = mount, .views = 8, .noise = kNoNoise});
    const auto found = calibrate_hand_eye(rig.views, {.mount = mount});
    ASSERT_TRUE(found) << found.error().to_string();
    EXPECT_LT(translation_distance(found->camera.T_a_b, rig.T_mount_camera), 1e-6);
    EXPECT_LT(rotation_distance(found->camera.T_a_b, rig.T_mount_camera), 1e-6);
    EXPECT_LT(translation_distance(found->board.T_a_b, rig.T_world_board), 1e-6);
    EXPECT_LT(found->leave_one_out_rms, 1e-6);
  }
}

TEST(CalibrateHandEye, StatesStdsThatHoldOn200RandomRigs) {
  std::vector<double> ratios;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const CameraMount mount = seed % 2 == 0 ? CameraMount::arm : CameraMount::base;
    const RandomRig rig(seed, {.mount = mount, .views = 15 + static_cast<int>(seed % 20)});
    const auto found = calibrate_hand_eye(rig.views, {.mount = mount, .splits = 0});
    ASSERT_TRUE(found) << found.error().to_string();
    const Pose difference = found->camera.T_a_b.inverse() * rig.T_mount_camera;
    const Eigen::Vector3d position = found->camera.T_a_b.rotation() * difference.translation();
    const Eigen::Vector3d rotation =
        found->camera.T_a_b.rotation() * Eigen::Vector3d(difference.log().tail<3>());
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_TRUE(found->camera.position_std[axis]);
      ratios.push_back(position[axis] / *found->camera.position_std[axis]);
      ratios.push_back(rotation[axis] / found->camera.rotation_std[axis]);
    }
  }
  expect_stds_cover(ratios, 8.0);
}

TEST(CalibrateHandEye, ProposesAPoseThatTheArmWasNear) {
  int proposed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const CameraMount mount = seed % 2 == 0 ? CameraMount::arm : CameraMount::base;
    const RandomRig rig(seed, {.mount = mount, .views = 6, .max_tilt = 0.3});
    const auto found = calibrate_hand_eye(rig.views, {.mount = mount, .splits = 0});
    ASSERT_TRUE(found) << found.error().to_string();
    if (!found->next) continue;
    ++proposed;
    double farthest = 0.0, turn = 7.0;
    Eigen::AlignedBox3d box;
    for (const HandEyeView& view : rig.views) {
      const Eigen::Vector3d& p_base_flange = view.T_base_flange.translation();
      farthest = std::max(farthest, p_base_flange.norm());
      box.extend(p_base_flange);
      turn = std::min(turn, rotation_distance(view.T_base_flange, found->next->T_base_flange));
    }
    const Eigen::Vector3d& p = found->next->T_base_flange.translation();
    EXPECT_LE(p.norm(), farthest) << seed;
    EXPECT_LE(box.exteriorDistance(p), 0.1 * std::sqrt(3.0)) << seed;
    EXPECT_LT(turn, 0.8) << seed;  // 45 degrees
  }
  EXPECT_GT(proposed, 10);
}

}  // namespace
}  // namespace pcavr
