// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pcavr/base/core/median.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// A distance on a tag: its squared components by depth, and its square by the manifest [m^2]. With
/// scale errors kx, ky and kz of the axes: kx^2 x + ky^2 y + kz^2 z = stated.
struct SquaredLength {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double stated = 0.0;
};

/// Edges and diagonals of the measured tags.
std::vector<SquaredLength> squared_lengths(const Manifest& manifest,
                                           const std::vector<TagMeasurement>& measurements) {
  std::vector<SquaredLength> lengths;
  for (const TagMeasurement& tag : measurements) {
    const double size = manifest.markers[tag.marker].size;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        const Eigen::Array3d squares =
            (tag.corners_camera[j] - tag.corners_camera[i]).array().square();
        const bool is_diagonal = j - i == 2;
        lengths.push_back(
            {squares.x(), squares.y(), squares.z(), (is_diagonal ? 2.0 : 1.0) * size * size});
      }
    }
  }
  return lengths;
}

/// Axes that have the scale error; the others are correct.
struct Hypothesis {
  bool has_x = false;
  bool has_y = false;
  bool has_z = false;
};
constexpr Hypothesis kAllAxes{true, true, true};  ///< a tag's size, or the unit of depth
constexpr Hypothesis kBoth{true, true, false};
constexpr Hypothesis kFx{true, false, false};
constexpr Hypothesis kFy{false, true, false};

struct Fit {
  double factor = 1.0;    ///< of the lengths along the hypothesis's axes
  double residual = 0.0;  ///< median |log| of the corrected lengths' ratios
};

Fit fit(const Hypothesis& hypothesis, const std::vector<SquaredLength>& lengths) {
  /// A length perpendicular to the hypothesis's axes is not informative about them.
  constexpr double kMinShare = 0.3;
  std::vector<double> squares;
  for (const SquaredLength& length : lengths) {
    const double along = (hypothesis.has_x ? length.x : 0.0) + (hypothesis.has_y ? length.y : 0.0) +
                         (hypothesis.has_z ? length.z : 0.0);
    const double all = length.x + length.y + length.z;
    if (along < kMinShare * all) continue;
    squares.push_back(std::max(0.0, (length.stated - (all - along)) / along));
  }
  const double square = median(std::move(squares));
  std::vector<double> residuals;
  for (const SquaredLength& length : lengths) {
    const double corrected = (hypothesis.has_x ? square : 1.0) * length.x +
                             (hypothesis.has_y ? square : 1.0) * length.y +
                             (hypothesis.has_z ? square : 1.0) * length.z;
    residuals.push_back(0.5 * std::abs(std::log(std::max(1e-12, corrected) / length.stated)));
  }
  return {std::sqrt(square), median(std::move(residuals))};
}

ConsistencyFinding focal_finding(const Manifest& manifest, const Hypothesis& hypothesis,
                                 const Fit& found, std::size_t frames,
                                 double contradiction_factor) {
  const CameraModel& camera = *manifest.camera;
  const double factor = std::max(found.factor, 1.0 / found.factor);
  ConsistencyFinding finding{.severity = factor >= contradiction_factor
                                             ? FindingSeverity::contradiction
                                             : FindingSeverity::warning,
                             .file = "recording.yaml",
                             .message = {},
                             .hint = {},
                             .factor = factor,
                             .frames = frames};
  const bool has_both = hypothesis.has_x && hypothesis.has_y;
  finding.place = has_both ? "camera.fx, camera.fy" : hypothesis.has_x ? "camera.fx" : "camera.fy";
  const auto values = [&](double divisor) {
    const std::string fx = number(std::round(10.0 * camera.fx / divisor) / 10.0);
    const std::string fy = number(std::round(10.0 * camera.fy / divisor) / 10.0);
    return has_both ? fx + " and " + fy : hypothesis.has_x ? fx : fy;
  };
  // Too small a focal length makes the measured lengths too large by the same factor.
  finding.message = values(1.0) + " px, but by images and depth the tags are square with " +
                    values(found.factor) + " px (" + factor_over_frames(finding.factor, frames) +
                    ")";
  finding.hint =
      has_both ? "check that fx and fy belong to images of this size" : "check fx and fy";
  return finding;
}

}  // namespace

std::optional<ConsistencyFinding> check_focal_lengths(
    const Manifest& manifest, const std::vector<TagMeasurement>& measurements,
    std::size_t min_frames, const ConsistencyOptions& options) {
  /// A hypothesis is accepted where its residual is less than this share of the alternative's:
  /// improbable by chance over the many lengths of three frames.
  constexpr double kDecisiveLensShare = 0.5;
  std::size_t frames = 0;
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    frames += i == 0 || measurements[i].frame != measurements[i - 1].frame ? 1 : 0;
  }
  if (frames < min_frames) return std::nullopt;
  const std::vector<SquaredLength> lengths = squared_lengths(manifest, measurements);
  const Fit scale = fit(kAllAxes, lengths);
  const Hypothesis* best = nullptr;
  Fit best_fit = scale;
  for (const Hypothesis* hypothesis : {&kBoth, &kFx, &kFy}) {
    const Fit found = fit(*hypothesis, lengths);
    if (found.residual >= best_fit.residual) continue;
    best = hypothesis;
    best_fit = found;
  }
  const double factor = std::max(best_fit.factor, 1.0 / best_fit.factor);
  if (best == nullptr || best_fit.residual > kDecisiveLensShare * scale.residual)
    return std::nullopt;
  if (!std::isfinite(factor) || factor < options.warning_factor) return std::nullopt;
  return focal_finding(manifest, *best, best_fit, frames, options.contradiction_factor);
}

}  // namespace pcavr
