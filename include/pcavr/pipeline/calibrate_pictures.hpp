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
