// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/camera_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"

#include "perception/board/camera_bundle.hpp"
#include "perception/board/missing_view.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinViews = 3;
constexpr std::size_t kFewViews = 10;  ///< fewer give stds that are uncertain themselves
constexpr double kMaxRatio = 4.0;      ///< a view's rms over the median's: more is another cause
constexpr double kMinOutlier = 0.5;    ///< [px] less is a good view among better ones
constexpr std::size_t kFolds = 5;
constexpr double kMaxFocalStd = 0.05;  ///< of the focal length: more is no calibration
constexpr double kMinCovered = 0.6;
constexpr double kMinTilt = 0.26;  ///< [rad] 15 degrees: of the most tilted view

Error too_few_views(std::size_t count) {
  return {
      .message = fmt::format("{} views of the board are too few: {} are needed, and ten or "
                             "more for a judgement",
                             count, kMinViews),
      .place = "PICTURES",
      .hint = "take pictures with the board tilted about both of its axes, in all of the image"};
}

double tilt_of(const Pose& T_camera_board) {
  const Eigen::Vector3d camera = T_camera_board.inverse().translation();
  return std::acos(std::clamp(std::abs(camera.z()) / camera.norm(), 0.0, 1.0));
}

/// The views that fit the others, by their indices.
std::vector<std::size_t> fitting_views(const BundleFit& fit) {
  const double limit = std::max(kMaxRatio * median(fit.view_rms), kMinOutlier);
  std::vector<std::size_t> fitting;
  for (std::size_t i = 0; i < fit.view_rms.size(); ++i) {
    if (fit.view_rms[i] <= limit) fitting.push_back(i);
  }
  return fitting;
}

/// Of views that were not fitted; each one's pose is fitted to its own points.
std::optional<double> held_out_rms(const CameraBundle& all, const std::vector<std::size_t>& used,
                                   const BundleFit& fit, const BundleOptions& options) {
  if (used.size() < 2 * kFolds) return std::nullopt;
  double sum = 0.0, points = 0.0;
  BundleOptions at_noise = options;
  at_noise.with_noise = false;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<std::size_t> train, judged;
    for (std::size_t i = 0; i < used.size(); ++i) {
      (i % kFolds == fold ? judged : train).push_back(used[i]);
    }
    const CameraBundle of_train = all.of(train, fit.model.camera);
    const BundleFit found = fit_bundle(of_train.views, of_train.start, fit.noise, at_noise);
    const CameraBundle of_judged = all.of(judged, found.model.camera);
    const BundleFit poses = fit_bundle(of_judged.views, of_judged.start, fit.noise,
                                       {.with_rig = false, .with_noise = false});
    for (std::size_t i = 0; i < judged.size(); ++i) {
      const auto count = static_cast<double>(of_judged.views[i].pixels.size());
      sum += poses.view_rms[i] * poses.view_rms[i] * count;
      points += count;
    }
  }
  return std::sqrt(sum / points);
}

void count_coverage(const BoardViews& views, const std::vector<std::size_t>& used,
                    CameraCalibration& result) {
  for (const std::size_t index : used) {
    for (const Eigen::Vector2d& pixel : views.views[index].pixels) {
      const int column =
          std::clamp(static_cast<int>(kCoverageColumns * (pixel.x() + 0.5) / views.width), 0,
                     kCoverageColumns - 1);
      const int row = std::clamp(static_cast<int>(kCoverageRows * (pixel.y() + 0.5) / views.height),
                                 0, kCoverageRows - 1);
      ++result.coverage[static_cast<std::size_t>(row * kCoverageColumns + column)];
    }
  }
  const auto filled = std::count_if(result.coverage.begin(), result.coverage.end(),
                                    [](int points) { return points > 0; });
  result.covered = static_cast<double>(filled) / static_cast<double>(result.coverage.size());
}

void add_notes(CameraCalibration& result) {
  double tilt = 0.0;
  std::size_t used = 0;
  for (const CalibratedView& view : result.views) {
    if (view.is_outlier) {
      result.notes.push_back(
          fmt::format("{} does not fit, and is left out: {:.2f} px; others {:.2f} px", view.name,
                      view.rms, result.pixel_rms));
      continue;
    }
    ++used;
    tilt = std::max(tilt, view.tilt);
  }
  if (used < kFewViews) {
    result.notes.push_back(
        fmt::format("{} views are few: standard deviations are uncertain themselves", used));
  }
  if (tilt < kMinTilt) {
    result.notes.push_back(
        fmt::format("no view is tilted by more than {:.0f} degrees: the focal length shows by "
                    "perspective, tilt "
                    "the board by 30 to 50 degrees",
                    tilt * 180.0 / std::numbers::pi));
  }
  if (result.covered < kMinCovered) {
    result.notes.push_back(
        fmt::format("points cover {:.0f} % of the image: beyond them the lens is not known",
                    100.0 * result.covered));
  }
}

}  // namespace

Expected<CameraCalibration> calibrate_camera(const BoardViews& views, const Board& board,
                                             const CameraCalibrationOptions& options) {
  if (views.views.size() < kMinViews) return too_few_views(views.views.size());
  const BundleOptions freed = camera_freedom(options);
  const CameraBundle all = CameraBundle::of_views(views, board, options.lens);
  std::vector<std::size_t> used = all.indices();
  BundleFit fit = fit_bundle(all.views, all.start, {}, freed);
  const std::vector<std::size_t> fitting = fitting_views(fit);
  if (fitting.size() < used.size() && fitting.size() >= kMinViews) {
    used = fitting;
    const CameraBundle sound = all.of(used, fit.model.camera);
    fit = fit_bundle(sound.views, sound.start, {}, freed);
  }
  CameraCalibration result{.camera = fit.model.camera};
  const std::size_t coefficients = coefficient_count(options.lens);
  const auto count = static_cast<Eigen::Index>(4 + coefficients);
  result.covariance = fit.covariance.block(kCameraParameter, kCameraParameter, count, count);
  for (Eigen::Index i = 0; i < result.covariance.rows(); ++i) {
    result.stds.push_back(std::sqrt(std::max(result.covariance(i, i), 0.0)));
  }
  if (!(result.stds[0] < kMaxFocalStd * result.camera.fx)) {
    return Error{.message = "the focal length does not show in these views",
                 .place = "PICTURES",
                 .hint = "tilt the board by 30 to 50 degrees about both of its axes"};
  }
  result.pixel_rms = fit.pixel_rms;
  result.noise = fit.noise.pixel;
  result.held_out_rms = held_out_rms(all, used, fit, freed);
  const CameraBundle judged = all.of(all.indices(), result.camera);
  const BundleFit poses =
      fit_bundle(judged.views, judged.start, fit.noise, {.with_rig = false, .with_noise = false});
  for (std::size_t i = 0; i < judged.views.size(); ++i) {
    const Pose T_camera_board = poses.model.T_base_flange[i].inverse();
    result.views.push_back({.name = views.views[all.given[i]].name,
                            .T_camera_board = T_camera_board,
                            .rms = poses.view_rms[i],
                            .tilt = tilt_of(T_camera_board),
                            .is_outlier = !std::binary_search(used.begin(), used.end(), i)});
  }
  std::vector<std::size_t> given;
  for (const std::size_t index : used) given.push_back(all.given[index]);
  count_coverage(views, given, result);
  plan_missing_view(fit, board, freed, result);
  add_notes(result);
  return result;
}

}  // namespace pcavr
