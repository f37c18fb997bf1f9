// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/pose_outliers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kPositionStd = 3e-4;  // [m]
constexpr double kRotationStd = 1e-3;  // [rad]

/// A body at rest, then pushed by 0.1 m at `speed` [m/s] while it turns by 20 degrees, at rest
/// again.
std::vector<TrackedPose> pushed_body(double rate, double speed) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<TrackedPose> poses;
  const double duration = 0.1 / speed;
  for (int i = 0; i < static_cast<int>((2.0 + duration) * rate); ++i) {
    const double t = i / rate;
    const double share = std::clamp((t - 1.0) / duration, 0.0, 1.0);
    Vector6d error;
    for (int k = 0; k < 6; ++k) {
      error[k] = noise(random) * (k < 3 ? kPositionStd : kRotationStd) / std::sqrt(3.0);
    }
    const Pose exact(Eigen::Quaterniond(Eigen::AngleAxisd(0.35 * share, Eigen::Vector3d::UnitZ())),
                     Eigen::Vector3d(0.5 + 0.1 * share, 0.1, 0.05));
    poses.push_back({t, exact * Pose::exp(error), kPositionStd, kRotationStd});
  }
  return poses;
}

void turn(TrackedPose& pose, double angle, const Eigen::Vector3d& axis) {
  pose.T_base_object = pose.T_base_object * Pose(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)),
                                                 Eigen::Vector3d::Zero());
}

std::vector<double> stamps_of(const std::vector<TrackedPose>& poses) {
  std::vector<double> stamps;
  for (const TrackedPose& pose : poses) stamps.push_back(pose.t);
  return stamps;
}

TEST(PoseOutliers, NoneInSoundMotionsOfAnyRate) {
  for (const double rate : {5.0, 15.0, 30.0, 120.0, 360.0}) {
    for (const double speed : {0.01, 0.1, 0.3, 0.8}) {
      std::vector<TrackedPose> poses = pushed_body(rate, speed);
      const std::size_t count = poses.size();
      EXPECT_EQ(remove_pose_outliers(poses).count, 0U) << rate << " Hz, " << speed << " m/s";
      EXPECT_EQ(poses.size(), count);
    }
  }
}

TEST(PoseOutliers, OneFlippedPoseIsRemovedAtRestInMotionAndAtTheEnds) {
  const std::vector<TrackedPose> sound = pushed_body(30.0, 0.1);
  for (std::size_t i = 0; i < sound.size(); ++i) {
    std::vector<TrackedPose> poses = sound;
    turn(poses[i], 0.5 * std::numbers::pi, Eigen::Vector3d::UnitX());
    const PoseOutliers found = remove_pose_outliers(poses);
    EXPECT_EQ(found.count, 1U) << i;
    EXPECT_EQ(found.first, sound[i].t);
    EXPECT_EQ(poses.size() + 1, sound.size());
    EXPECT_FALSE(std::any_of(poses.begin(), poses.end(),
                             [&](const TrackedPose& pose) { return pose.t == sound[i].t; }));
  }
}

TEST(PoseOutliers, OnePoseBesideTheOthersIsRemoved) {
  for (const double distance : {0.03, 1.0, 1e6}) {
    std::vector<TrackedPose> poses = pushed_body(30.0, 0.1);
    poses[40].T_base_object =
        Pose::from_translation({0.0, distance, 0.0}) * poses[40].T_base_object;
    EXPECT_EQ(remove_pose_outliers(poses).count, 1U) << distance;
  }
}

TEST(PoseOutliers, ThreeFlippedPosesInARowAreRemoved) {
  std::vector<TrackedPose> poses = pushed_body(30.0, 0.1);
  for (const std::size_t i : {20U, 21U, 22U}) {
    turn(poses[i], std::numbers::pi, Eigen::Vector3d::UnitZ());
  }
  EXPECT_EQ(remove_pose_outliers(poses).count, 3U);
}

TEST(PoseOutliers, ABodyThatIsCarriedElsewhereIsNoOutlier) {
  std::vector<TrackedPose> poses = pushed_body(30.0, 0.1);
  for (std::size_t i = 60; i < poses.size(); ++i) {
    poses[i].T_base_object = Pose::from_translation({0.3, 0.0, 0.0}) * poses[i].T_base_object;
  }
  EXPECT_EQ(remove_pose_outliers(poses).count, 0U);
}

TEST(PoseOutliers, NoiseAboveTheStatedStdIsNoOutlier) {
  std::vector<TrackedPose> poses = pushed_body(120.0, 0.1);
  for (TrackedPose& pose : poses) pose.position_std = pose.rotation_std = 1e-7;
  EXPECT_EQ(remove_pose_outliers(poses).count, 0U);
}

TEST(PoseOutliers, PosesBeforeAndAfterAMotionOnlyAreKept) {
  std::vector<TrackedPose> poses = pushed_body(30.0, 0.1);
  std::erase_if(poses, [](const TrackedPose& pose) { return pose.t > 1.0 && pose.t < 2.0; });
  EXPECT_EQ(remove_pose_outliers(poses).count, 0U);
}

TEST(PoseOutliers, AStreamPassesSoundPosesAtOnce) {
  PoseOutlierFilter filter(PoseSource::stream);
  for (const TrackedPose& pose : pushed_body(30.0, 0.2)) {
    EXPECT_EQ(stamps_of(filter.add(pose)), std::vector<double>{pose.t});
  }
  EXPECT_EQ(filter.outliers().count, 0U);
}

TEST(PoseOutliers, AStreamRejectsAFlipAndPassesTheNextPose) {
  PoseOutlierFilter filter(PoseSource::stream);
  std::vector<TrackedPose> poses = pushed_body(30.0, 0.1);
  turn(poses[22], std::numbers::pi, Eigen::Vector3d::UnitX());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(filter.add(poses[i]).size(), i == 22 ? 0U : 1U) << i;
  }
  EXPECT_EQ(filter.outliers().count, 1U);
  EXPECT_EQ(filter.outliers().first, poses[22].t);
}

TEST(PoseOutliers, AStreamAcceptsABodyThatStaysWhereItJumpedTo) {
  PoseOutlierFilter filter(PoseSource::stream);
  std::vector<TrackedPose> poses = pushed_body(30.0, 0.1);
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i >= 40) turn(poses[i], 0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ());
    accepted += filter.add(poses[i]).size();
    if (i == 50) {
      EXPECT_EQ(accepted, 51U);  // a third of a second later
    }
  }
  EXPECT_EQ(filter.outliers().count, 0U);
}

TEST(PoseOutliers, AreDescribedWithTheFirst) {
  EXPECT_EQ(describe({3, 0.733333}), "the pose jumps and returns, first at t = 0.733333 s");
}

}  // namespace
}  // namespace pcavr
