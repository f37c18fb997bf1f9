// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/tag_plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/pixel.hpp"

namespace pcavr {
namespace {

/// Share of the tag, from its centre, whose pixels are used: those near its edge may mix tag and
/// background.
constexpr double kInnerShare = 0.85;
/// Fewer pixels than this do not determine a slope.
constexpr std::size_t kMinPixels = 30;
/// Tukey's biweight rejects residuals beyond this many standard deviations; 4.685 keeps 95 %
/// efficiency.
constexpr double kTukey = 4.685;

struct InverseDepth {
  Eigen::Vector3d ray;     ///< (x, y, 1) relative to the tag's centre in x and y
  double value = 0.0;      ///< [1/m]
  double value_std = 0.0;  ///< [1/m]
};

bool is_inside(const std::array<Eigen::Vector2d, 4>& corners, const Eigen::Vector2d& p) {
  // Clockwise on the screen.
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector2d b = p - corners[i];
    if (a.x() * b.y() - a.y() * b.x() > 0.0) return false;
  }
  return true;
}

std::vector<InverseDepth> collect_samples(const DepthImage& depth, const DepthNoise& noise,
                                          const CameraModel& camera,
                                          const std::array<Eigen::Vector2d, 4>& corners,
                                          const Eigen::Vector2d& centre) {
  std::array<Eigen::Vector2d, 4> inner;
  Eigen::AlignedBox2d box;
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  for (std::size_t i = 0; i < 4; ++i) {
    inner[i] = middle + kInnerShare * (corners[i] - middle);
    box.extend(inner[i]);
  }
  const int x0 = clamp_to_int(std::ceil(box.min().x()), 0, depth.width());
  const int y0 = clamp_to_int(std::ceil(box.min().y()), 0, depth.height());
  const int x1 = clamp_to_int(std::floor(box.max().x()), -1, depth.width() - 1);
  const int y1 = clamp_to_int(std::floor(box.max().y()), -1, depth.height() - 1);
  std::vector<InverseDepth> samples;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const double z = static_cast<double>(depth(x, y));
      if (!(z >= noise.min_depth && z <= noise.max_depth)) continue;
      if (!is_inside(inner, {x, y})) continue;
      const Eigen::Vector2d at = camera.normalise({x, y}) - centre;
      samples.push_back({{at.x(), at.y(), 1.0}, 1.0 / z, noise.depth_std(z) / (z * z)});
    }
  }
  return samples;
}

struct Fit {
  Eigen::Vector3d solution;
  Eigen::Matrix3d information;
  double weight = 0.0;  ///< effective number of pixels
};

/// One iteration of iteratively reweighted least squares (IRLS).
Fit weighted_fit(const std::vector<InverseDepth>& samples, const Fit* last, double scale) {
  Fit fit{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero(), 0.0};
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const InverseDepth& sample : samples) {
    double weight = 1.0;
    if (last != nullptr) {
      const double u =
          (sample.ray.dot(last->solution) - sample.value) / (kTukey * scale * sample.value_std);
      weight = std::abs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
    }
    const double information = weight / (sample.value_std * sample.value_std);
    fit.information += information * sample.ray * sample.ray.transpose();
    right += information * sample.value * sample.ray;
    fit.weight += weight;
  }
  fit.solution = fit.information.ldlt().solve(right);
  return fit;
}

/// Robust standard deviation of the residuals from their median magnitude (MAD), in units of the
/// noise model's; at least 1.
double residual_scale(const std::vector<InverseDepth>& samples, const Eigen::Vector3d& solution) {
  std::vector<double> magnitudes;
  for (const InverseDepth& sample : samples) {
    magnitudes.push_back(std::abs(sample.ray.dot(solution) - sample.value) / sample.value_std);
  }
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return std::max(1.0, kStdOverMad * *middle);
}

}  // namespace

std::optional<PlaneMeasurement> measure_tag_plane(const DepthImage& depth, const DepthNoise& noise,
                                                  const CameraModel& camera,
                                                  const std::array<Eigen::Vector2d, 4>& corners,
                                                  int tag_count, const BodyPoseOptions& options) {
  const Eigen::Vector2d centre =
      camera.normalise(0.25 * (corners[0] + corners[1] + corners[2] + corners[3]));
  const std::vector<InverseDepth> samples = collect_samples(depth, noise, camera, corners, centre);
  if (samples.size() < kMinPixels) return std::nullopt;

  double scale = 1.0;
  Fit fit = weighted_fit(samples, nullptr, scale);
  for (int i = 0; i < 5; ++i) {
    scale = residual_scale(samples, fit.solution);
    fit = weighted_fit(samples, &fit, scale);
  }
  if (fit.weight < 0.5 * static_cast<double>(samples.size()) || !fit.solution.allFinite()) {
    return std::nullopt;
  }

  Eigen::Matrix3d covariance =
      fit.information.inverse() * (scale * scale * options.depth_correlation_area);
  const double z = 1.0 / fit.solution.z();
  const double systematic = noise.depth_std(z) / (z * z);
  const double slope = systematic / options.distortion_length;
  covariance.diagonal() +=
      tag_count * Eigen::Vector3d(slope * slope, slope * slope, systematic * systematic);

  // Shifts from coordinates relative to the tag's centre to the camera's.
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift(2, 0) = -centre.x();
  shift(2, 1) = -centre.y();
  const Eigen::Matrix3d information = (shift * covariance * shift.transpose()).inverse();
  if (!information.allFinite()) return std::nullopt;
  return PlaneMeasurement{shift * fit.solution, information.llt().matrixU()};
}

}  // namespace pcavr
