// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/import.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "perception/tracking/camera_surface.hpp"
#include "support/shared_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr double kDegree = 3.14159265358979 / 180.0;

CameraTrack track(const Recording& recording) {
  CameraTracker tracker(recording.manifest, recording.groundtruth);
  TagDetector detector = std::move(TagDetector::create({"tag36h11"}).value());
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const RgbdFrame frame = decode_frame(recording, i).value();
    tracker.add(frame, detector.detect(to_gray(frame.color)), {}, Parallelism::max());
  }
  return tracker.solve();
}

struct Errors {
  std::size_t placed = 0;
  double position_rmse = 0.0;  ///< [m]
  double rotation_rmse = 0.0;  ///< [rad]
};

/// Errors in base, without trajectory alignment.
Errors position_errors(const Trajectory& truth, const CameraTrack& track) {
  Errors errors;
  for (const FramePlacement& frame : track.frames) {
    if (frame.status != PlacementStatus::placed) continue;
    const Pose expected = truth.at(frame.stamp).value();
    ++errors.placed;
    errors.position_rmse += std::pow(translation_distance(expected, frame.T_base_camera), 2);
    errors.rotation_rmse += std::pow(rotation_distance(expected, frame.T_base_camera), 2);
  }
  const auto count = static_cast<double>(errors.placed);
  errors.position_rmse = std::sqrt(errors.position_rmse / count);
  errors.rotation_rmse = std::sqrt(errors.rotation_rmse / count);
  return errors;
}

TEST(CameraPositionError, OfAHandHeldCameraIsBelowAMillimetre) {
  PCAVR_NEEDS_SHARED_DATA("tabletop");
  const Recording recording = read_recording(shared_data("tabletop")).value();
  const Trajectory truth = read_trajectory(shared_data("tabletop/truth/camera.txt")).value();
  const CameraTrack result = track(recording);
  const Errors errors = position_errors(truth, result);
  EXPECT_EQ(errors.placed, recording.frames.size());
  EXPECT_LT(errors.position_rmse, 0.001);
  EXPECT_LT(errors.rotation_rmse, 0.1 * kDegree);
  for (const FramePlacement& frame : result.frames) {
    const Pose expected = truth.at(frame.stamp).value();
    EXPECT_LT(translation_distance(expected, frame.T_base_camera), 3.0 * frame.position_std);
    EXPECT_LT(rotation_distance(expected, frame.T_base_camera), 3.0 * frame.rotation_std);
  }
}

/// Every `step`-th frame.
Recording thinned(Recording recording, std::size_t step) {
  std::vector<FrameFiles> kept;
  for (std::size_t i = 0; i < recording.frames.size(); i += step) {
    kept.push_back(recording.frames[i]);
  }
  recording.frames = std::move(kept);
  return recording;
}

// Views 0.2 to 0.4 m apart; the tag is seen in the first and the last ones. A view aligns with the
// one before as well when it slides along the table.
TEST(CameraPositionError, OfViewsFarApartIsBelowAMillimetreOrTheyAreNotPlaced) {
  PCAVR_NEEDS_SHARED_DATA("tabletop");
  const Recording recording = read_recording(shared_data("tabletop")).value();
  const Trajectory truth = read_trajectory(shared_data("tabletop/truth/camera.txt")).value();
  for (const std::size_t step : {12, 15, 30}) {
    const CameraTrack result = track(thinned(recording, step));
    const Errors errors = position_errors(truth, result);
    EXPECT_LT(errors.position_rmse, 0.001) << step;
    EXPECT_LT(errors.rotation_rmse, 0.1 * kDegree) << step;
    EXPECT_GE(errors.placed, step <= 15 ? result.frames.size() : 1U) << step;
  }
}

// Errors are against the track by all frames: the given poses contradict the images by up to 75 mm
// at the end.
TEST(CameraPositionError, OfRealViewsFarApartIsWithinThreeStandardDeviations) {
  PCAVR_NEEDS_SHARED_DATA("real/seven_scenes");
  const TemporaryFolder folder;
  ASSERT_TRUE(import_recording(shared_data("real/seven_scenes"), folder.path()));
  const Recording recording = read_recording(folder.path()).value();
  const CameraTrack all = track(recording);
  for (const std::size_t step : {15, 20}) {
    const CameraTrack few = track(thinned(recording, step));
    for (std::size_t i = 0; i < few.frames.size(); ++i) {
      const FramePlacement& frame = few.frames[i];
      EXPECT_EQ(frame.status, PlacementStatus::placed);
      const Pose& expected = all.frames[i * step].T_base_camera;
      const double error = translation_distance(expected, frame.T_base_camera);
      EXPECT_LT(error, 3.0 * frame.position_std) << "frame " << i * step;
      EXPECT_LT(error, 0.015) << "frame " << i * step;
    }
  }
}

TEST(CameraPositionError, OfAFixedCameraIsBelowAMillimetreWithMovingBoxes) {
  PCAVR_NEEDS_SHARED_DATA("push_two_boxes");
  const Recording recording = read_recording(shared_data("push_two_boxes")).value();
  const Trajectory truth = read_trajectory(shared_data("push_two_boxes/truth/camera.txt")).value();
  const CameraTrack result = track(recording);
  EXPECT_TRUE(result.is_fixed_camera);
  const Errors errors = position_errors(truth, result);
  EXPECT_EQ(errors.placed, recording.frames.size());
  EXPECT_LT(errors.position_rmse, 0.001);
  EXPECT_LT(errors.rotation_rmse, 0.1 * kDegree);
}

/// Distances of one frame's surface from the planes of another's, up to 5 cm [m].
void add_distances(const tracking::CellGrid& grid, const tracking::Surface& model,
                   const tracking::InverseDepth& frame, const Pose& T_model_frame,
                   std::vector<double>& distances) {
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (frame[i] <= 0.0F) continue;
    const Eigen::Vector3f p_frame = grid.rays[i].homogeneous() / frame[i];
    const Eigen::Vector3d p = T_model_frame * p_frame.cast<double>();
    if (p.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = grid.camera.project(p);
    if (!grid.camera.contains(pixel)) continue;
    const auto cell =
        static_cast<std::size_t>(std::lround(pixel.y()) * grid.width() + std::lround(pixel.x()));
    const Eigen::Vector3d normal = model.normals[cell].cast<double>();
    const double distance = std::abs(normal.dot(p - model.points[cell].cast<double>()));
    if (!normal.isZero() && distance < 0.05) distances.push_back(distance);
  }
}

/// Median point-to-plane distance of frames `gap` apart, with the poses from `pose_of` [m].
double self_consistency(const std::vector<tracking::InverseDepth>& frames,
                        const tracking::CellGrid& grid, std::size_t gap,
                        const std::function<Pose(std::size_t)>& pose_of) {
  std::vector<double> distances;
  for (std::size_t i = 0; i + gap < frames.size(); i += 10) {
    const tracking::Surface model = tracking::make_surface(grid, frames[i], DepthNoise());
    add_distances(grid, model, frames[i + gap], pose_of(i).inverse() * pose_of(i + gap), distances);
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

TEST(CameraPositionError, OfRealFramesIsBelowThatOfTheGivenPoses) {
  PCAVR_NEEDS_SHARED_DATA("real/seven_scenes");
  const TemporaryFolder folder;
  ASSERT_TRUE(import_recording(shared_data("real/seven_scenes"), folder.path()));
  const Recording recording = read_recording(folder.path()).value();
  const CameraTrack result = track(recording);
  const tracking::CellGrid grid(*recording.manifest.camera);
  std::vector<tracking::InverseDepth> frames;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    ASSERT_EQ(result.frames[i].status, PlacementStatus::placed);
    frames.push_back(tracking::cell_inverse_depth(grid, decode_frame(recording, i).value().depth,
                                                  {}, DepthNoise()));
  }
  const auto given = [&](std::size_t i) {
    return recording.groundtruth.at(recording.frames[i].depth_stamp).value();
  };
  const auto tracked = [&](std::size_t i) { return result.frames[i].T_base_camera; };
  for (const std::size_t gap : {5, 30}) {
    const double distance = self_consistency(frames, grid, gap, tracked);
    EXPECT_LT(distance, self_consistency(frames, grid, gap, given)) << "gap " << gap;
    EXPECT_LT(distance, 0.006) << "gap " << gap;
  }
}

}  // namespace
}  // namespace pcavr
