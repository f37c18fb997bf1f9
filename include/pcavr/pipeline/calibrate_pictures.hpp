// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/board/camera_calibration.hpp"
#include "pcavr/perception/board/picture_rig.hpp"
#include "pcavr/pipeline/calibrate.hpp"

namespace pcavr {

/// Pictures of a board with the arm's poses of the same numbers.
struct PairedPictures {
  std::vector<ArmPicture> views = {};
  int width = 0, height = 0;  ///< [px]
  std::string format = {};    ///< how the arm's poses were recognised
  std::vector<std::string> notes = {};
};
[[nodiscard]] Expected<PairedPictures> read_paired_pictures(const PoseInput& robot,
                                                            const std::string& pictures,
                                                            const Board& board,
                                                            Parallelism parallelism);

/// Of a camera's file: pcavr's own, with stds, and those of ROS (camera_info), OpenCV (FileStorage)
/// and Kalibr (camchain), which have the intrinsics alone.
enum class CameraFormat { pcavr, ros, opencv, kalibr };
/// Kalibr has no rational lens, nor k3: an Error.
[[nodiscard]] Expected<std::string> format_camera(const CameraCalibration& found,
                                                  const std::string& pictures, const Board& board,
                                                  CameraFormat format);

/// How far apart views have the same surfaces, by their depth and the poses of the rig.
struct DepthAgreement {
  std::size_t views = 0, pairs = 0;   ///< ordered pairs of views that overlap
  double median = 0.0;                ///< [m] of all points to the nearest of the other view
  double least = 0.0, largest = 0.0;  ///< [m] of the pairs' medians
};
/// Compares depth images (16-bit PNG, aligned to the pictures, in a folder that may be named by
/// what its files' names begin with) of the same numbers as the rig's pictures, up to 1.5 times the
/// board's distance and 5 cm apart. An Error where fewer than two are there, or none overlap.
[[nodiscard]] Expected<DepthAgreement> compare_depth(const PictureRig& rig, const Board& board,
                                                     const std::string& depth_images,
                                                     double units_per_metre);

/// A calibration of kind hand-eye, with the camera, if it was estimated, and each view's pose.
[[nodiscard]] std::string format_picture_rig(const PictureRig& found, const PoseInput& robot,
                                             const std::string& pictures, const Board& board);

/// Each writes report.html and report.json, which has the same figures, to a folder.
[[nodiscard]] Expected<void> write_camera_report(const CameraCalibration& found,
                                                 const BoardViews& views, const Board& board,
                                                 const std::string& report_json,
                                                 const std::filesystem::path& folder);
[[nodiscard]] Expected<void> write_picture_rig_report(const PictureRig& found,
                                                      const PairedPictures& input,
                                                      const Board& board,
                                                      const std::string& report_json,
                                                      const std::filesystem::path& folder);

}  // namespace pcavr
