// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/build/placement_warnings.hpp"

#include <gtest/gtest.h>

#include "pcavr/perception/tracking/stated_poses.hpp"

namespace pcavr {
namespace {

Stamp stamp_of(std::size_t frame) { return Stamp{static_cast<std::int64_t>(frame) * 100'000'000}; }

/// Ten frames in a row, known to 2 mm.
CameraTrack a_track() {
  CameraTrack track;
  for (std::size_t i = 0; i < 10; ++i) {
    FramePlacement frame;
    frame.frame = i;
    frame.stamp = stamp_of(i);
    frame.status = PlacementStatus::placed;
    frame.T_base_camera = Pose::from_translation({0.1 * static_cast<double>(i), 0.0, 0.0});
    frame.position_std = 0.002;
    track.frames.push_back(frame);
  }
  return track;
}

TEST(PlacementWarnings, NameTheFramesThatAreLeftOut) {
  CameraTrack track = a_track();
  EXPECT_TRUE(placement_warnings(track, {}, {}).empty());
  for (const std::size_t i : {2, 3, 4, 7}) track.frames[i].status = PlacementStatus::not_anchored;
  track.frames[9].status = PlacementStatus::lost;
  const std::vector<std::string> warnings = placement_warnings(track, {}, {});
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_TRUE(warnings[0].starts_with("frames 2 to 4, 7 are left out")) << warnings[0];
  EXPECT_TRUE(warnings[1].starts_with("frame 9 is left out")) << warnings[1];
}

TEST(PlacementWarnings, PosesThatAreKnownToMetresOnlyAreAnError) {
  CameraTrack track = a_track();
  EXPECT_FALSE(undetermined_camera(track, "hall"));
  for (std::size_t i = 0; i < 4; ++i)
    track.frames[i].position_std = 1.7;  // a few are left to fusion
  EXPECT_FALSE(undetermined_camera(track, "hall"));
  for (FramePlacement& frame : track.frames) frame.position_std = 1.7;
  const std::optional<Error> error = undetermined_camera(track, "hall");
  ASSERT_TRUE(error);
  EXPECT_TRUE(error->to_string().starts_with(
      "hall: the camera's poses are known to +-1.70 m, +-0 deg only; show base tags"))
      << error->to_string();
  for (FramePlacement& frame : track.frames) frame.position_std = 0.002;
  for (FramePlacement& frame : track.frames) frame.rotation_std = 1.7;
  EXPECT_TRUE(undetermined_camera(track, "hall"));
}

TEST(PlacementWarnings, NameGivenPosesThatTheImagesContradict) {
  const CameraTrack track = a_track();
  Trajectory given;
  for (std::size_t i = 0; i < 10; ++i) {
    const double error = i < 8 ? 0.01 : 0.06;
    given.append(stamp_of(i),
                 track.frames[i].T_base_camera * Pose::from_translation({0.0, error, 0.0}));
  }
  const std::vector<std::string> warnings = placement_warnings(track, given, {});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("frames 8, 9 are up to 60 mm and 0.0 deg off"), std::string::npos)
      << warnings[0];
  CameraTrackerOptions trusting;
  trusting.trust_poses = true;
  EXPECT_TRUE(placement_warnings(track, given, trusting).empty());
}

TEST(PlacementWarnings, AreAnErrorWhereTheStdOfThePosesIsStated) {
  CameraTrack track = a_track();
  track.frames[9].base_tags = 2;
  Trajectory given;
  for (std::size_t i = 0; i < 10; ++i) {
    const double error = i < 8 ? 0.005 : 0.1 * static_cast<double>(i - 7);
    given.append(stamp_of(i),
                 track.frames[i].T_base_camera * Pose::from_translation({0.0, error, 0.0}));
  }
  CameraTrackerOptions options;
  EXPECT_FALSE(moved_poses(track, given, options, "hall")) << "the std is the default";
  state_pose_std(options.groundtruth_position_std, options);
  const std::optional<Error> error = moved_poses(track, given, options, "hall");
  ASSERT_TRUE(error);
  EXPECT_EQ(
      error->message,
      "its poses of 2 frames are contradicted by more than 5 stds: frame 9 by 200 mm and 0.0 deg "
      "(23 stds, base tags in view), frame 8 by 100 mm and 0.0 deg (11 stds, other views)");
  state_pose_std(0.1, options);
  EXPECT_FALSE(moved_poses(track, given, options, "hall"));
  state_pose_std(0.001, options);
  options.trust_poses = true;
  EXPECT_FALSE(moved_poses(track, given, options, "hall"));
}

}  // namespace
}  // namespace pcavr
