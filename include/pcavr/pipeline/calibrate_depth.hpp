// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"

namespace pcavr {

struct DepthInput {
  std::filesystem::path recording;
  std::size_t max_frames = 300;  ///< evenly spaced: more of one recording repeat each other
  bool skip_bad = false;
};

/// The depth's error within one cell of the image, summed over pixels of one tag.
struct DepthCell {
  int cell = 0;  ///< row by row, kDepthCellColumns in each
  int pixels = 0;
  double depth = 0.0;    ///< [m] sum of the measured depth
  double missing = 0.0;  ///< [m] sum of the depth by the tags less the measured one
};
inline constexpr int kDepthCellColumns = 32, kDepthCellRows = 24;

/// A tag in one image: how far it is by depth, and by its corners.
struct DepthView {
  std::size_t frame = 0;    ///< in Recording::frames
  std::string tag = {};     ///< "tag36h11:3"
  std::size_t place = 0;    ///< views from one place are one measurement, however many there are
  double by_depth = 0.0;    ///< [m] along the optical axis, mean over the tag's pixels
  double by_tags = 0.0;     ///< [m] of the same pixels
  double plane_rms = 0.0;   ///< [m] of the pixels about their own plane
  double plane_tilt = 0.0;  ///< [rad] between that plane and the tag's
  std::vector<DepthCell> cells = {};
};

struct DepthViews {
  double depth_scale = 1.0;   ///< units/m, and
  double depth_offset = 0.0;  ///< [m] by which the depth was read
  std::size_t frames = 0;     ///< that were searched
  std::size_t places = 0;
  std::vector<DepthView> views = {};
  std::vector<std::string> notes = {};  ///< for the user
};

/// Measures the recording's tags in its images, by depth and by their corners alone: the pose of a
/// body by all of its tags that are in view. Pixels near a tag's edge are left out, and views whose
/// pose the corners do not decide. An Error where there are no depth images or no tags.
[[nodiscard]] Expected<DepthViews> read_depth_views(const DepthInput& input,
                                                    const Observer& observer);

/// True depth = scale * measured + offset. An error of the tags' sizes or of the focal length looks
/// like one of the scale: both are taken as right.
struct DepthCalibration {
  double scale = 1.0, scale_std = 0.0;
  bool has_offset = false;  ///< the distances differ enough to show it; else it is taken as 0
  double offset = 0.0, offset_std = 0.0;                 ///< [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of scale, offset [m]
  double depth_scale = 1.0;                              ///< units/m for camera.depth_scale
  double depth_offset = 0.0;                             ///< [m] for camera.depth_offset
  double nearest = 0.0, farthest = 0.0;                  ///< [m] of the tags
  double before_rms = 0.0;              ///< [m] of the places' errors as the depth was read
  double fitted_rms = 0.0;              ///< [m] with the correction
  double held_out_rms = 0.0;            ///< [m] of each place by the others
  double plane_rms = 0.0;               ///< [m] median of the views
  double plane_tilt = 0.0;              ///< [rad] median of the views
  std::vector<double> cells = {};       ///< [m] mean error left in each cell; NaN where no tag was
  std::vector<std::string> notes = {};  ///< for the user
};

/// Fits scale and offset to the places' means, with Huber's loss. The covariance is that of the
/// jackknife over places [Efron and Tibshirani 1993, ch. 11], which contains what views of one
/// place share. An Error where there are fewer than five places.
[[nodiscard]] Expected<DepthCalibration> calibrate_depth(const DepthViews& views);

/// One sentence: whether the depth agrees with the tags.
[[nodiscard]] std::string describe_depth(const DepthCalibration& found);

/// A calibration that recordings name (`calibration:`).
[[nodiscard]] std::string format_depth(const DepthCalibration& found, const DepthInput& input);

/// Writes report.html and report.json, which has the same figures, to a folder.
[[nodiscard]] Expected<void> write_depth_report(const DepthCalibration& found,
                                                const DepthViews& views,
                                                const std::string& report_json,
                                                const std::filesystem::path& folder);

}  // namespace pcavr
