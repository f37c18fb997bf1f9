// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/tracking/camera_tracker.hpp"

#include <cmath>
#include <functional>
#include <map>

#include <gtest/gtest.h>

#include "pcavr/core/check.hpp"

#include "camera_scene.hpp"

namespace pcavr {
namespace {

using camera_scene::a_camera;
using camera_scene::a_manifest;
using camera_scene::look;
using camera_scene::render;
using camera_scene::Scene;
using camera_scene::see_tags;
using camera_scene::stamp_of;
using camera_scene::walk;

constexpr double kPeriod = 0.05;  // [s]

/// A recording in the making: what each frame shows can be chosen by index.
struct Shoot {
  int frames = 16;
  CameraModel camera = a_camera();
  std::function<Pose(double)> path = walk;
  std::function<bool(int)> is_tag_seen = [](int) { return true; };
  std::function<void(int, Scene&)> arrange = [](int, Scene&) {};
  std::function<void(int, RgbdFrame&)> spoil = [](int, RgbdFrame&) {};
  std::function<void(int, std::vector<TagDetection>&)> spoil_tags =
      [](int, std::vector<TagDetection>&) {};
  double color_lag = 0.0;  ///< colour stamps behind depth stamps [s]
  Trajectory groundtruth = {};
  CameraTrackerOptions options = {};
  int threads = 1;
};

CameraTrack track(const Shoot& shoot) {
  const Manifest manifest = a_manifest(shoot.camera);
  CameraTracker tracker(manifest, shoot.groundtruth, shoot.options);
  for (int i = 0; i < shoot.frames; ++i) {
    const double t = i * kPeriod;
    const auto index = static_cast<std::size_t>(i);
    Scene scene;
    shoot.arrange(i, scene);
    const Pose T_base_color = shoot.path(t + shoot.color_lag);
    RgbdFrame frame = render(scene, shoot.camera, T_base_color, shoot.path(t), index);
    frame.depth_stamp = stamp_of(t);
    frame.color_stamp = stamp_of(t + shoot.color_lag);
    shoot.spoil(i, frame);
    std::vector<TagDetection> tags;
    if (shoot.is_tag_seen(i)) tags = see_tags(manifest, T_base_color, index);
    shoot.spoil_tags(i, tags);
    tracker.add(frame, tags, {}, {shoot.threads});
  }
  return tracker.solve();
}

/// Largest distance from the truth over the placed frames [m].
double worst_position(const CameraTrack& track, const std::function<Pose(double)>& path = walk) {
  double worst = 0.0;
  for (const FramePlacement& frame : track.frames) {
    if (frame.status != PlacementStatus::placed) continue;
    const Pose truth = path(static_cast<double>(frame.frame) * kPeriod);
    worst = std::max(worst, translation_distance(truth, frame.T_base_camera));
  }
  return worst;
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

// Corners are off by 0.1 px and depth by half a Kinect's noise: a tag of 43 px gives a camera at
// 1.2 m to about 2 mm, and dense tracking adds a fraction of a millimetre.
constexpr double kPositionTolerance = 0.004;  // [m]

TEST(CameraTracker, PlacesEveryFrameThoughTheTagIsSeenOnlyAtFirst) {
  Shoot shoot;
  shoot.frames = 24;
  shoot.is_tag_seen = [](int i) { return i < 8; };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::placed), 24);
  EXPECT_FALSE(result.is_fixed_camera);
  EXPECT_LT(worst_position(result), kPositionTolerance);
  EXPECT_EQ(result.tag_corners_used, 32);
  EXPECT_TRUE(result.why_not.empty());
}

TEST(CameraTracker, ErrorsStayWithinThreeStandardDeviations) {
  Shoot shoot;
  shoot.is_tag_seen = [](int i) { return i % 5 == 0; };
  for (const FramePlacement& frame : track(shoot).frames) {
    const Pose truth = walk(static_cast<double>(frame.frame) * kPeriod);
    EXPECT_LT(translation_distance(truth, frame.T_base_camera), 3.0 * frame.position_sigma);
    EXPECT_LT(rotation_distance(truth, frame.T_base_camera), 3.0 * frame.rotation_sigma);
    EXPECT_LT(frame.position_sigma, 0.02);  // a bound that says nothing would be no figure
  }
}

TEST(CameraTracker, GivesAFixedCameraOnePoseThoughABlockMoves) {
  Shoot shoot;
  shoot.path = [](double) { return walk(0.3); };
  shoot.arrange = [](int i, Scene& scene) {
    scene.first_block_motion = Eigen::Vector3d(0.0, -0.01 * std::max(0, i - 4), 0.0);
    scene.blocks[0].translate(scene.first_block_motion);
  };
  const CameraTrack result = track(shoot);
  ASSERT_EQ(count(result, PlacementStatus::placed), shoot.frames);
  EXPECT_TRUE(result.is_fixed_camera);
  for (const FramePlacement& frame : result.frames) {
    EXPECT_EQ(frame.T_base_camera.matrix(), result.frames.front().T_base_camera.matrix());
  }
  EXPECT_LT(worst_position(result, shoot.path), 0.002);  // sixteen looks average the corners
}

TEST(CameraTracker, LeavesOutABlankFrameAndGoesOnBehindIt) {
  Shoot shoot;
  shoot.is_tag_seen = [](int i) { return i < 6; };
  shoot.spoil = [](int i, RgbdFrame& frame) {
    if (i == 9 || i == 10) blank(frame);
  };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::lost), 2);
  EXPECT_EQ(result.frames[9].status, PlacementStatus::lost);
  EXPECT_EQ(result.frames[15].status, PlacementStatus::placed);
  EXPECT_LT(worst_position(result), kPositionTolerance);
}

TEST(CameraTracker, PlacesAFrameWithoutDepthByTheTagInIt) {
  Shoot shoot;
  shoot.frames = 8;
  shoot.spoil = [](int i, RgbdFrame& frame) {
    if (i == 4) blank(frame);
  };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(result.frames[4].status, PlacementStatus::placed);
  // One look at one tag; a frame beside it has its neighbours' too.
  EXPECT_GT(result.frames[4].position_sigma, result.frames[3].position_sigma);
  EXPECT_LT(worst_position(result), 3.0 * result.frames[4].position_sigma);
}

TEST(CameraTracker, FindsItsPlaceAgainAfterAJump) {
  Shoot shoot;
  shoot.frames = 20;
  shoot.is_tag_seen = [](int i) { return i < 4; };
  // Away to the side over the first 12 frames, then back near the start at once.
  shoot.path = [](double t) { return t < 11.5 * kPeriod ? walk(2.0 * t) : walk(t - 0.55); };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::placed), 20);
  EXPECT_LT(worst_position(result, shoot.path), kPositionTolerance);
}

TEST(CameraTracker, NeverGuessesWhereAStretchLiesThatNothingTiesToBase) {
  Shoot shoot;
  shoot.is_tag_seen = [](int i) { return i < 4; };
  // The second half looks at the other side of the wall.
  shoot.path = [](double t) {
    return t < 7.5 * kPeriod ? walk(t) : look({2.0, 0.1 * t, 0.6}, {0.7, 0.3 + 0.1 * t, 0.5});
  };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::placed), 8);
  EXPECT_EQ(count(result, PlacementStatus::not_anchored), 8);
  EXPECT_LT(worst_position(result, shoot.path), kPositionTolerance);
}

TEST(CameraTracker, SaysWhyNothingIsAnchoredWithoutTagsAndPoses) {
  Shoot shoot;
  shoot.frames = 6;
  shoot.is_tag_seen = [](int) { return false; };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::not_anchored), 6);
  EXPECT_NE(result.why_not.find("no base tag was seen"), std::string::npos) << result.why_not;
}

TEST(CameraTracker, SaysWhyAnEmptyRecordingHasNoTrack) {
  EXPECT_EQ(CameraTracker(a_manifest(), {}).solve().why_not, "no frames");
}

TEST(CameraTracker, LetsGoOfATagThatWasReadTheWrongWayRound) {
  Shoot shoot;
  shoot.spoil_tags = [](int i, std::vector<TagDetection>& tags) {
    if (i == 5)
      std::rotate(tags[0].corners.begin(), tags[0].corners.begin() + 2, tags[0].corners.end());
  };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(result.tag_corners_rejected, 4);
  EXPECT_EQ(count(result, PlacementStatus::placed), shoot.frames);
  EXPECT_LT(worst_position(result), kPositionTolerance);
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

TEST(CameraTracker, IsAnchoredByGroundtruthThoughSomeOfItIsWrong) {
  Shoot shoot;
  shoot.is_tag_seen = [](int) { return false; };
  shoot.groundtruth = given_poses(
      shoot.frames, [](int i) { return Eigen::Vector3d(i == 7 ? 0.2 : 0.0, 0.0, 0.0); });
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::placed), shoot.frames);
  EXPECT_LT(worst_position(result), kPositionTolerance);
}

TEST(CameraTracker, TakesTrustedPosesAsTheyAre) {
  Shoot shoot;
  shoot.frames = 5;
  shoot.options.trust_poses = true;
  shoot.groundtruth = given_poses(4, [](int) { return Eigen::Vector3d(0.0, 0.03, 0.0); });
  const CameraTrack result = track(shoot);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(result.frames[i].T_base_camera.matrix(), shoot.groundtruth.poses()[i].pose.matrix());
  }
  EXPECT_EQ(result.frames[4].status, PlacementStatus::not_anchored);
}

TEST(CameraTracker, PlacesDepthImagesWhereColourCame15MillisecondsLater) {
  Shoot shoot;
  shoot.color_lag = 0.015;  // 4 mm of the walk
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::placed), shoot.frames);
  EXPECT_LT(worst_position(result), kPositionTolerance);
}

TEST(CameraTracker, HonoursLensDistortion) {
  Shoot shoot;
  shoot.camera.distortion = {0.08, -0.12, 0.001, -0.0015, 0.0};
  shoot.is_tag_seen = [](int i) { return i < 8; };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::placed), shoot.frames);
  EXPECT_LT(worst_position(result), kPositionTolerance);
}

TEST(CameraTracker, HonoursAFisheye) {
  Shoot shoot;
  const std::array<double, 4> k = {-0.0117, 0.0301, -0.0274, 0.0079};
  shoot.camera.distortion = LensDistortion(LensModel::fisheye, k);
  shoot.is_tag_seen = [](int i) { return i < 8; };
  const CameraTrack result = track(shoot);
  EXPECT_EQ(count(result, PlacementStatus::placed), shoot.frames);
  EXPECT_LT(worst_position(result), kPositionTolerance);
}

TEST(CameraTracker, GivesTheSameBitsForAnyNumberOfThreads) {
  Shoot shoot;
  shoot.frames = 8;
  const CameraTrack expected = track(shoot);
  for (const int threads : {1, 2, 4}) {
    shoot.threads = threads;
    const CameraTrack result = track(shoot);
    ASSERT_EQ(result.frames.size(), expected.frames.size());
    for (std::size_t i = 0; i < result.frames.size(); ++i) {
      EXPECT_EQ(result.frames[i].T_base_camera.matrix(), expected.frames[i].T_base_camera.matrix());
      EXPECT_EQ(result.frames[i].position_sigma, expected.frames[i].position_sigma);
    }
  }
}

TEST(CameraTracker, IsSolvedOnce) {
  CameraTracker tracker(a_manifest(), {});
  (void)tracker.solve();
  EXPECT_THROW((void)tracker.solve(), ContractError);
}

}  // namespace
}  // namespace pcavr
