// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/tracking/camera_tracker.hpp"

#include <cmath>
#include <functional>
#include <map>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

#include "camera_scene.hpp"

namespace pcavr {
namespace {

using camera_scene::a_camera;
using camera_scene::a_manifest;
using camera_scene::detect_tags;
using camera_scene::look_at;
using camera_scene::render;
using camera_scene::Scene;
using camera_scene::stamp_of;
using camera_scene::walk;

constexpr double kPeriod = 0.05;  // [s]

/// A simulated recording; the content of each frame depends on its index.
struct SimulatedRecording {
  int frames = 16;
  CameraModel camera = a_camera();
  std::function<Pose(double)> path = walk;
  std::function<bool(int)> is_tag_seen = [](int) { return true; };
  std::function<void(int, Scene&)> change_scene = [](int, Scene&) {};
  std::function<void(int, RgbdFrame&)> corrupt_frame = [](int, RgbdFrame&) {};
  std::function<void(int, std::vector<TagDetection>&)> corrupt_tags =
      [](int, std::vector<TagDetection>&) {};
  double color_delay = 0.0;  ///< colour stamps minus depth stamps [s]
  Trajectory groundtruth = {};
  CameraTrackerOptions options = {};
  int threads = 1;
  std::size_t seed = 0;  ///< of the noise
};

CameraTrack track(const SimulatedRecording& recording) {
  const Manifest manifest = a_manifest(recording.camera);
  CameraTracker tracker(manifest, recording.groundtruth, recording.options);
  for (int i = 0; i < recording.frames; ++i) {
    const double t = i * kPeriod;
    const std::size_t index = static_cast<std::size_t>(i) + 100 * recording.seed;
    Scene scene;
    recording.change_scene(i, scene);
    const Pose T_base_color = recording.path(t + recording.color_delay);
    RgbdFrame frame = render(scene, recording.camera, T_base_color, recording.path(t), index);
    frame.index = static_cast<std::size_t>(i);
    frame.depth_stamp = stamp_of(t);
    frame.color_stamp = stamp_of(t + recording.color_delay);
    recording.corrupt_frame(i, frame);
    std::vector<TagDetection> tags;
    if (recording.is_tag_seen(i)) tags = detect_tags(manifest, T_base_color, index);
    recording.corrupt_tags(i, tags);
    tracker.add(frame, tags, {}, {recording.threads});
  }
  return tracker.solve();
}

/// Maximum position error over the placed frames [m].
double max_position_error(const CameraTrack& track,
                          const std::function<Pose(double)>& path = walk) {
  double max_error = 0.0;
  for (const FramePlacement& frame : track.frames) {
    if (frame.status != PlacementStatus::placed) continue;
    const Pose truth = path(static_cast<double>(frame.frame) * kPeriod);
    max_error = std::max(max_error, translation_distance(truth, frame.T_base_camera));
  }
  return max_error;
}

int count(const CameraTrack& track, PlacementStatus status) {
  int frames = 0;
  for (const FramePlacement& frame : track.frames) frames += frame.status == status ? 1 : 0;
  return frames;
}

void blank(RgbdFrame& frame) {
  std::fill(frame.color.pixels().begin(), frame.color.pixels().end(), Rgb8{});
  std::fill(frame.depth.pixels().begin(), frame.depth.pixels().end(), 0.0F);
}

// Corners have noise of 0.1 px and depth half a Kinect's noise: a tag of 43 px locates a camera at
// 1.2 m to about 2 mm, and dense tracking adds a fraction of a millimetre.
constexpr double kPositionTolerance = 0.004;  // [m]

TEST(CameraTracker, PlacesEveryFrameWithTheTagVisibleOnlyAtFirst) {
  SimulatedRecording recording;
  recording.frames = 24;
  recording.is_tag_seen = [](int i) { return i < 8; };
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::placed), 24);
  EXPECT_FALSE(result.is_fixed_camera);
  EXPECT_LT(max_position_error(result), kPositionTolerance);
  EXPECT_EQ(result.tag_corners_used, 32);
  EXPECT_TRUE(result.failure_reason.empty());
}

TEST(CameraTracker, ErrorsStayWithinThreeStandardDeviations) {
  SimulatedRecording recording;
  recording.is_tag_seen = [](int i) { return i % 5 == 0; };
  for (const FramePlacement& frame : track(recording).frames) {
    const Pose truth = walk(static_cast<double>(frame.frame) * kPeriod);
    EXPECT_LT(translation_distance(truth, frame.T_base_camera), 3.0 * frame.position_std);
    EXPECT_LT(rotation_distance(truth, frame.T_base_camera), 3.0 * frame.rotation_std);
    EXPECT_LT(frame.position_std, 0.02);  // not trivially large
  }
}

TEST(CameraTracker, GivesAFixedCameraOnePoseWithAMovingBlock) {
  SimulatedRecording recording;
  recording.path = [](double) { return walk(0.3); };
  recording.change_scene = [](int i, Scene& scene) {
    scene.first_block_motion = Eigen::Vector3d(0.0, -0.01 * std::max(0, i - 4), 0.0);
    scene.blocks[0].translate(scene.first_block_motion);
  };
  const CameraTrack result = track(recording);
  ASSERT_EQ(count(result, PlacementStatus::placed), recording.frames);
  EXPECT_TRUE(result.is_fixed_camera);
  for (const FramePlacement& frame : result.frames) {
    EXPECT_EQ(frame.T_base_camera.matrix(), result.frames.front().T_base_camera.matrix());
  }
  EXPECT_LT(max_position_error(result, recording.path),
            0.002);  // corners averaged over sixteen frames
}

TEST(CameraTracker, MarksABlankFrameAsLostAndContinues) {
  SimulatedRecording recording;
  recording.is_tag_seen = [](int i) { return i < 6; };
  recording.corrupt_frame = [](int i, RgbdFrame& frame) {
    if (i == 9 || i == 10) blank(frame);
  };
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::lost), 2);
  EXPECT_EQ(result.frames[9].status, PlacementStatus::lost);
  EXPECT_EQ(result.frames[15].status, PlacementStatus::placed);
  EXPECT_LT(max_position_error(result), kPositionTolerance);
}

TEST(CameraTracker, PlacesAFrameWithoutDepthByItsTag) {
  SimulatedRecording recording;
  recording.frames = 8;
  recording.corrupt_frame = [](int i, RgbdFrame& frame) {
    if (i == 4) blank(frame);
  };
  const CameraTrack result = track(recording);
  EXPECT_EQ(result.frames[4].status, PlacementStatus::placed);
  // One observation of one tag; the neighbouring frame is also linked to others.
  EXPECT_GT(result.frames[4].position_std, result.frames[3].position_std);
  EXPECT_LT(max_position_error(result), 3.0 * result.frames[4].position_std);
}

TEST(CameraTracker, RelocalisesAfterAJump) {
  SimulatedRecording recording;
  recording.frames = 20;
  recording.is_tag_seen = [](int i) { return i < 4; };
  // Moves to the side over the first 12 frames, then jumps back near the start.
  recording.path = [](double t) { return t < 11.5 * kPeriod ? walk(2.0 * t) : walk(t - 0.55); };
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::placed), 20);
  EXPECT_LT(max_position_error(result, recording.path), kPositionTolerance);
}

TEST(CameraTracker, DoesNotPlaceASegmentWithoutALinkToBase) {
  SimulatedRecording recording;
  recording.is_tag_seen = [](int i) { return i < 4; };
  // The second half looks at the other side of the wall.
  recording.path = [](double t) {
    return t < 7.5 * kPeriod ? walk(t) : look_at({2.0, 0.1 * t, 0.6}, {0.7, 0.3 + 0.1 * t, 0.5});
  };
  // Four frames see the tag: their error is common to all frames, and follows the stated std.
  constexpr std::size_t kDraws = 7;
  double squares = 0.0;
  double position_std = 0.0;
  for (recording.seed = 0; recording.seed < kDraws; ++recording.seed) {
    const CameraTrack result = track(recording);
    EXPECT_EQ(count(result, PlacementStatus::placed), 8);
    EXPECT_EQ(count(result, PlacementStatus::not_anchored), 8);
    position_std = result.frames[0].position_std;
    const double error = max_position_error(result, recording.path);
    EXPECT_LT(error, 2.0 * position_std);
    squares += error * error / kDraws;
  }
  EXPECT_LT(std::sqrt(squares), position_std);
  EXPECT_LT(position_std, 0.008);
}

TEST(CameraTracker, ReportsWhyNothingIsAnchoredWithoutTagsAndPoses) {
  SimulatedRecording recording;
  recording.frames = 6;
  recording.is_tag_seen = [](int) { return false; };
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::not_anchored), 6);
  EXPECT_NE(result.failure_reason.find("no base tag was detected"), std::string::npos)
      << result.failure_reason;
}

TEST(CameraTracker, ReportsWhyAnEmptyRecordingHasNoTrack) {
  EXPECT_EQ(CameraTracker(a_manifest(), {}).solve().failure_reason, "no frames");
}

TEST(CameraTracker, RejectsATagWithRotatedCorners) {
  SimulatedRecording recording;
  recording.corrupt_tags = [](int i, std::vector<TagDetection>& tags) {
    if (i == 5)
      std::rotate(tags[0].corners.begin(), tags[0].corners.begin() + 2, tags[0].corners.end());
  };
  const CameraTrack result = track(recording);
  EXPECT_EQ(result.tag_corners_rejected, 4);
  EXPECT_EQ(count(result, PlacementStatus::placed), recording.frames);
  EXPECT_LT(max_position_error(result), kPositionTolerance);
}

/// The walk's poses, each moved by `error`.
Trajectory given_poses(int frames, const std::function<Eigen::Vector3d(int)>& error) {
  Trajectory poses;
  for (int i = 0; i < frames; ++i) {
    const Pose truth = walk(i * kPeriod);
    poses.append(stamp_of(i * kPeriod), Pose(truth.rotation(), truth.translation() + error(i)));
  }
  return poses;
}

TEST(CameraTracker, IsAnchoredByGroundtruthWithOutliers) {
  SimulatedRecording recording;
  recording.is_tag_seen = [](int) { return false; };
  recording.groundtruth = given_poses(
      recording.frames, [](int i) { return Eigen::Vector3d(i == 7 ? 0.2 : 0.0, 0.0, 0.0); });
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::placed), recording.frames);
  EXPECT_LT(max_position_error(result), kPositionTolerance);
}

TEST(CameraTracker, KeepsGivenPosesWhereAnotherPlaceLooksTheSame) {
  // A hall of equal bays, 3 m apart: from frame 14 on the camera is in another one than before.
  const Eigen::Vector3d bay(0.0, 3.0, 0.0);
  const auto path = [&](double t) {
    const Pose in_bay = walk(t);
    return t < 13.5 * kPeriod ? in_bay : Pose(in_bay.rotation(), in_bay.translation() + bay);
  };
  SimulatedRecording recording;
  recording.frames = 20;
  recording.is_tag_seen = [](int) { return false; };
  for (int i = 0; i < recording.frames; ++i) {
    recording.groundtruth.append(stamp_of(i * kPeriod), path(i * kPeriod));
  }
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::placed), recording.frames);
  EXPECT_GT(result.links_rejected, 0U);
  EXPECT_LT(max_position_error(result, path), 0.015);  // 3 std of the given poses
}

TEST(CameraTracker, RejectsNoLinksWhereMostContradictTheGivenPosesAsInAnotherUnit) {
  SimulatedRecording recording;
  for (int i = 0; i < recording.frames; ++i) {
    const Pose truth = walk(i * kPeriod);
    recording.groundtruth.append(stamp_of(i * kPeriod),
                                 Pose(truth.rotation(), 1000.0 * truth.translation()));
  }
  const CameraTrack result = track(recording);
  EXPECT_EQ(result.links_rejected, 0U);
  for (const FramePlacement& frame : result.frames) EXPECT_EQ(frame.segment, 0);
}

/// Paints a chessboard on the table, whose squares have an edge of 8 cm.
void paint_chessboard(const CameraModel& camera, const Pose& T_base_camera, RgbdFrame& frame) {
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray =
          T_base_camera.rotation() * camera.normalise(Eigen::Vector2d(x, y)).homogeneous();
      const Eigen::Vector3d p =
          T_base_camera.translation() - T_base_camera.translation().z() / ray.z() * ray;
      const auto square = static_cast<int>(std::floor(p.x() / 0.08) + std::floor(p.y() / 0.08));
      const std::uint8_t value = square % 2 == 0 ? 40 : 210;
      frame.color(x, y) = {value, value, value};
    }
  }
}

TEST(CameraTracker, DoesNotSlideAlongAPatternWhereTheGivenPosesSayHowItMoved) {
  SimulatedRecording recording;
  recording.frames = 6;
  // Each view is nearly as far from the one before as the pattern's period of 16 cm.
  recording.path = [](double t) {
    const double along = 0.13 * t / kPeriod;
    return look_at({-0.8 + along, 0.1, 0.9}, {-0.4 + along, 0.1, 0.0});
  };
  recording.is_tag_seen = [](int) { return false; };
  recording.change_scene = [](int, Scene& scene) { scene.blocks.clear(); };
  recording.corrupt_frame = [&](int i, RgbdFrame& frame) {
    paint_chessboard(recording.camera, recording.path(i * kPeriod), frame);
  };
  for (int i = 0; i < recording.frames; ++i) {
    const Pose truth = recording.path(i * kPeriod);
    const Eigen::Vector3d error(i % 2 == 0 ? 0.01 : -0.01, i % 3 == 0 ? 0.01 : -0.005, 0.0);
    recording.groundtruth.append(stamp_of(i * kPeriod),
                                 Pose(truth.rotation(), truth.translation() + error));
  }
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::placed), recording.frames);
  EXPECT_LT(max_position_error(result, recording.path), 0.015);
}

TEST(CameraTracker, UsesTrustedPosesUnchanged) {
  SimulatedRecording recording;
  recording.frames = 5;
  recording.options.trust_poses = true;
  recording.groundtruth = given_poses(4, [](int) { return Eigen::Vector3d(0.0, 0.03, 0.0); });
  const CameraTrack result = track(recording);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(result.frames[i].T_base_camera.matrix(),
              recording.groundtruth.poses()[i].pose.matrix());
  }
  EXPECT_EQ(result.frames[4].status, PlacementStatus::not_anchored);
}

TEST(CameraTracker, PlacesDepthImagesWithColourDelayedBy15Milliseconds) {
  SimulatedRecording recording;
  recording.color_delay = 0.015;  // 4 mm of the walk
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::placed), recording.frames);
  EXPECT_LT(max_position_error(result), kPositionTolerance);
}

TEST(CameraTracker, SupportsLensDistortion) {
  SimulatedRecording recording;
  recording.camera.distortion = {0.08, -0.12, 0.001, -0.0015, 0.0};
  recording.is_tag_seen = [](int i) { return i < 8; };
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::placed), recording.frames);
  EXPECT_LT(max_position_error(result), kPositionTolerance);
}

TEST(CameraTracker, SupportsAFisheyeLens) {
  SimulatedRecording recording;
  const std::array<double, 4> k = {-0.0117, 0.0301, -0.0274, 0.0079};
  recording.camera.distortion = LensDistortion(LensModel::fisheye, k);
  recording.is_tag_seen = [](int i) { return i < 8; };
  const CameraTrack result = track(recording);
  EXPECT_EQ(count(result, PlacementStatus::placed), recording.frames);
  EXPECT_LT(max_position_error(result), kPositionTolerance);
}

TEST(CameraTracker, IsBitwiseIdenticalForAnyNumberOfThreads) {
  SimulatedRecording recording;
  recording.frames = 8;
  const CameraTrack expected = track(recording);
  for (const int threads : {1, 2, 4}) {
    recording.threads = threads;
    const CameraTrack result = track(recording);
    ASSERT_EQ(result.frames.size(), expected.frames.size());
    for (std::size_t i = 0; i < result.frames.size(); ++i) {
      EXPECT_EQ(result.frames[i].T_base_camera.matrix(), expected.frames[i].T_base_camera.matrix());
      EXPECT_EQ(result.frames[i].position_std, expected.frames[i].position_std);
    }
  }
}

TEST(CameraTracker, ThrowsIfSolvedTwice) {
  CameraTracker tracker(a_manifest(), {});
  (void)tracker.solve();
  EXPECT_THROW((void)tracker.solve(), ContractError);
}

}  // namespace
}  // namespace pcavr
