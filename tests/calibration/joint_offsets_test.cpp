// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/joint_offsets.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibration/random_rig.hpp"
#include "support/std_coverage.hpp"

namespace pcavr {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Six joints by their lines at rest [Brockett 1984]: shoulder, elbow and a wrist.
Eigen::Matrix<double, 6, 6> lines_at_rest() {
  struct Line {
    Eigen::Vector3d direction, point;
  };
  const Line lines[] = {{{0, 0, 1}, {0, 0, 0}},     {{0, 1, 0}, {0, 0, 0.3}},
                        {{0, 1, 0}, {0, 0, 0.75}},  {{1, 0, 0}, {0.1, 0, 0.8}},
                        {{0, 1, 0}, {0.5, 0, 0.8}}, {{1, 0, 0}, {0.6, 0, 0.8}}};
  Eigen::Matrix<double, 6, 6> twists;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Line& line = lines[i];
    twists.col(i) << line.point.cross(line.direction), line.direction;
  }
  return twists;
}

ArmPose arm_at(const Eigen::VectorXd& q) {
  const Eigen::Matrix<double, 6, 6> twists = lines_at_rest();
  ArmPose arm;
  arm.jacobian_base.resize(6, 6);
  Eigen::Matrix<double, 3, 6> turns, shifts;  // of the point at base's origin
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Eigen::Vector3d turn = arm.T_base_flange.rotation() * twists.col(i).tail<3>();
    turns.col(i) = turn;
    shifts.col(i) = arm.T_base_flange.rotation() * twists.col(i).head<3>() +
                    arm.T_base_flange.translation().cross(turn);
    arm.T_base_flange = arm.T_base_flange * Pose::exp(twists.col(i) * q[i]);
  }
  arm.T_base_flange = arm.T_base_flange * Pose::from_translation({0.6, 0.0, 0.8});
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Eigen::Vector3d turn = turns.col(i);
    arm.jacobian_base.col(i) << shifts.col(i) + turn.cross(arm.T_base_flange.translation()), turn;
  }
  return arm;
}

/// An arm whose encoders are off, with a camera and a board.
struct OffsetRig {
  Eigen::VectorXd offsets = Eigen::VectorXd::Zero(6);
  std::vector<Eigen::VectorXd> read;
  Pose T_mount_camera, T_world_board;
  std::vector<HandEyeView> views;
  CameraMount mount = CameraMount::arm;

  OffsetRig(std::uint64_t seed, int count, double offset_std) {
    Random random(seed);
    mount = seed % 2 == 0 ? CameraMount::arm : CameraMount::base;
    // Of the first and last joint the poses would have another truth: shown by another test.
    for (Eigen::Index i = 1; i < 5; ++i) offsets[i] = offset_std * random.normal();
    Vector6d camera, board;
    camera << normal_vector(random, 0.05), normal_vector(random, 0.5);
    board << 0.9, 0.1, 0.2, normal_vector(random, 0.5);
    if (mount == CameraMount::base) camera.head<3>() += Eigen::Vector3d(1.3, 0.2, 0.7);
    if (mount == CameraMount::base) board.head<3>() = normal_vector(random, 0.05);
    T_mount_camera = Pose::exp(camera);
    T_world_board = Pose::exp(board);
    for (int i = 0; i < count; ++i) {
      Eigen::VectorXd q(6);
      for (Eigen::Index joint = 0; joint < 6; ++joint) q[joint] = random.uniform(-0.7, 0.7);
      read.push_back(q - offsets);
      const Pose T_base_flange = arm_at(q).T_base_flange;
      const Pose T_world_mount =
          mount == CameraMount::arm ? T_base_flange : T_base_flange.inverse();
      Pose T_camera_board = (T_world_mount * T_mount_camera).inverse() * T_world_board;
      Vector6d noise;
      noise << normal_vector(random, 2e-4), normal_vector(random, 4e-4);
      T_camera_board = T_camera_board * Pose::exp(noise);
      views.push_back(
          {"view " + std::to_string(i), arm_at(read.back()).T_base_flange, T_camera_board});
    }
  }

  [[nodiscard]] Expected<ArmHandEyeResult> found(int splits) const {
    const ArmModel arm = [this](std::size_t view, const Eigen::VectorXd& more) {
      return arm_at(read[view] + more);
    };
    return calibrate_hand_eye_and_arm(views, arm, {"a", "b", "c", "d", "e", "f"},
                                      {.mount = mount, .splits = splits});
  }
};

TEST(JointOffsets, TheJacobianOfTheTestsArmIsTheDifferenceOfTwoPoses) {
  Eigen::VectorXd q(6);
  q << 0.3, -0.2, 0.5, 0.4, -0.6, 0.1;
  const ArmPose at = arm_at(q);
  for (Eigen::Index i = 0; i < 6; ++i) {
    Eigen::VectorXd moved = q;
    moved[i] += 1e-6;
    const Pose after = arm_at(moved).T_base_flange;
    const Eigen::Vector3d v = (after.translation() - at.T_base_flange.translation()) / 1e-6;
    EXPECT_LT((v - at.jacobian_base.col(i).head<3>()).norm(), 1e-5) << i;
  }
}

TEST(JointOffsets, AreFoundAndUnseenViewsFitBetter) {
  for (const std::uint64_t seed : {2, 3}) {
    const OffsetRig rig(seed, 30, 0.3 * kDegree);
    const auto found = rig.found(4);
    ASSERT_TRUE(found) << found.error().to_string();
    for (Eigen::Index i = 0; i < 6; ++i) {
      const JointOffset& offset = found->offsets[static_cast<std::size_t>(i)];
      EXPECT_EQ(offset.is_held, i == 0 || i == 5) << offset.joint;
      EXPECT_NEAR(offset.value, rig.offsets[i], 0.05 * kDegree) << offset.joint;
      EXPECT_LE(std::abs(offset.value - rig.offsets[i]), 4.0 * offset.std) << offset.joint;
    }
    ASSERT_TRUE(found->hand_eye.held_out_rms && found->without.held_out_rms);
    EXPECT_LT(*found->hand_eye.held_out_rms, 0.8 * *found->without.held_out_rms);
    EXPECT_NE(found->hand_eye.notes.back().find("a, f: held at 0"), std::string::npos);
  }
}

TEST(JointOffsets, HaveStdsThatHoldOnRandomArms) {
  std::vector<double> ratios;
  for (std::uint64_t seed = 101; seed <= 112; ++seed) {
    const OffsetRig rig(seed, 20 + static_cast<int>(seed % 15), 0.3 * kDegree);
    const auto found = rig.found(0);
    ASSERT_TRUE(found) << seed << ' ' << found.error().to_string();
    for (Eigen::Index i = 1; i < 5; ++i) {
      const JointOffset& offset = found->offsets[static_cast<std::size_t>(i)];
      ratios.push_back((offset.value - rig.offsets[i]) / offset.std);
    }
    const CalibratedPose& camera = found->hand_eye.camera;
    const Vector6d error = (camera.T_a_b.inverse() * rig.T_mount_camera).log();
    for (Eigen::Index i = 0; i < 6; ++i) {
      ratios.push_back(error[i] / std::sqrt(camera.covariance(i, i)));
    }
  }
  // Of ten values of each of twelve arms, which share their errors; bench/calibration_stds.py draws
  // more.
  expect_stds_cover(ratios, 14.0);
}

TEST(JointOffsets, OfASoundArmAreNone) {
  const OffsetRig rig(5, 30, 0.0);
  const auto found = rig.found(0);
  ASSERT_TRUE(found) << found.error().to_string();
  for (const JointOffset& offset : found->offsets) {
    EXPECT_LE(std::abs(offset.value), 4.0 * offset.std + 1e-12) << offset.joint;
    EXPECT_LT(std::abs(offset.value), 0.1 * kDegree) << offset.joint;
  }
}

TEST(JointOffsets, NeedMoreViewsThanTheCameraDoes) {
  const OffsetRig rig(6, 6, 0.0);
  const auto found = rig.found(0);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("6 views are too few"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
