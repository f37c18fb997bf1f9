// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"

namespace pcavr {

enum class ImportFormat { tum_rgbd, seven_scenes };

/// Depth image units in one metre as such folders are published: TUM RGB-D 5000, 7-Scenes 1000.
[[nodiscard]] double usual_depth_scale(ImportFormat format);

struct ImportOptions {
  std::optional<ImportFormat> format = {};  ///< detected from the folder's files where not given
  /// Required for TUM RGB-D. 7-Scenes: without it, that of camera-intrinsics.txt, or where that is
  /// absent fx = fy = 585, cx = 320, cy = 240 for 640 x 480, as published, scaled to the images.
  std::optional<CameraModel> camera = {};
  /// Depth image units in one metre. Without it, the camera file's or the usual one: where they
  /// differ, the one under which the readings are in the sensor's range, in doubt the file's.
  std::optional<double> depth_scale = {};
  std::optional<double> camera_depth_scale = {};  ///< of the camera file
  std::optional<DepthNoise> depth_noise = {};     ///< of the camera file: its range counts
  double frame_rate = 30.0;  ///< [Hz], 0.1 to 1e5, for sources without timestamps
  std::size_t stride = 1;    ///< take every n-th frame
  std::size_t first = 0;     ///< skip the frames before this one
};

/// The depth scale of an imported recording, and the one that was possible, too.
struct ImportedDepthScale {
  double used = 0.0;                 ///< [units/m]
  std::optional<double> other = {};  ///< [units/m] nullopt: there was no choice
  /// Shares of the readings in the sensor's range under either; nullopt: its range is not known.
  std::optional<double> share_in_range = {};
  std::optional<double> other_share_in_range = {};
};

struct ImportReport {
  ImportFormat format = ImportFormat::tum_rgbd;
  ImportedDepthScale depth_scale = {};
  std::size_t frames = 0;
  std::size_t poses = 0;           ///< rows of `groundtruth.txt`
  std::size_t left_out = 0;        ///< images without a match in time
  std::size_t poses_left_out = 0;  ///< pose files that are absent, not finite or not rigid
};

/// Converts a TUM RGB-D or 7-Scenes folder to a recording at `target` (an existing, empty folder).
/// Its poses become `groundtruth.txt`, so that the source's world frame becomes the base frame; its
/// z axis need not point up. Invalid depth (7-Scenes: 65535) becomes 0. Colour is copied unchanged.
/// A TUM RGB-D folder has no intrinsics: without options.camera it is an Error.
[[nodiscard]] Expected<ImportReport> import_recording(const std::filesystem::path& source,
                                                      const std::filesystem::path& target,
                                                      const ImportOptions& options = {},
                                                      const Observer& observer = {});

}  // namespace pcavr
