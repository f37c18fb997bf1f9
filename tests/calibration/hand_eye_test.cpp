// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/hand_eye.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "calibration/random_rig.hpp"

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
  int within = 0, all = 0;
  double largest = 0.0;
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
      for (const double ratio : {position[axis] / *found->camera.position_std[axis],
                                 rotation[axis] / found->camera.rotation_std[axis]}) {
        within += std::abs(ratio) < 1.0 ? 1 : 0;
        largest = std::max(largest, std::abs(ratio));
        ++all;
      }
    }
  }
  const double share = 100.0 * within / all;
  std::printf("  within one std: %.1f %%, largest error %.2f std\n", share, largest);
  EXPECT_NEAR(share, 68.0, 8.0);
  EXPECT_LT(largest, 5.0);
}

}  // namespace
}  // namespace pcavr
