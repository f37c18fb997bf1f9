// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/trajectory_errors.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/matched_poses.hpp"

namespace pcavr {
namespace {

PoseError error_between(Stamp stamp, const Pose& reference, const Pose& estimate) {
  return {stamp, translation_distance(reference, estimate), rotation_distance(reference, estimate)};
}

/// The error of the motion from `first` to `second`.
PoseError error_of_motion(const MatchedPose& first, const MatchedPose& second) {
  return error_between(second.stamp, first.reference.inverse() * second.reference,
                       first.estimate.inverse() * second.estimate);
}

/// Least-squares alignment [Umeyama 1991, eq. 40 to 42, with scale 1] (Kabsch algorithm).
std::optional<Pose> best_rigid_motion(const std::vector<MatchedPose>& matched) {
  if (matched.size() < 3) return std::nullopt;
  Eigen::Vector3d mean_reference = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_estimate = Eigen::Vector3d::Zero();
  for (const MatchedPose& pair : matched) {
    mean_reference += pair.reference.translation();
    mean_estimate += pair.estimate.translation();
  }
  const auto count = static_cast<double>(matched.size());
  mean_reference /= count;
  mean_estimate /= count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const MatchedPose& pair : matched) {
    covariance += (pair.reference.translation() - mean_reference) *
                  (pair.estimate.translation() - mean_estimate).transpose() / count;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  // The rotation needs two directions with a spread of more than 0.1 mm: below, it is the rounding
  // of the files.
  constexpr double kMinVariance = 1e-8;  // [m^2]
  if (svd.singularValues()[1] < kMinVariance) return std::nullopt;
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return Pose(Eigen::Quaterniond(rotation), mean_reference - rotation * mean_estimate);
}

/// Index of the pose nearest to one step after `from`, if it is a step away +-10 % (evo's default
/// tolerance). Empty where the trajectory ends before: the last pose would be in many pairs, all
/// too short.
std::optional<std::size_t> one_step_later(const std::vector<MatchedPose>& matched, std::size_t from,
                                          Duration step) {
  const Stamp target = matched[from].stamp + step;
  auto best =
      std::lower_bound(matched.begin() + static_cast<std::ptrdiff_t>(from), matched.end(), target,
                       [](const MatchedPose& pair, Stamp stamp) { return pair.stamp < stamp; });
  if (best == matched.end()) return std::nullopt;
  if (target - (best - 1)->stamp < best->stamp - target) --best;
  const Duration difference = best->stamp > target ? best->stamp - target : target - best->stamp;
  if (difference > step / 10) return std::nullopt;
  return static_cast<std::size_t>(best - matched.begin());
}

}  // namespace

double quantile(const std::vector<double>& ascending, double share) {
  PCAVR_REQUIRE(!ascending.empty());
  PCAVR_REQUIRE(share >= 0.0 && share <= 1.0, share);
  const double position = share * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  const double fraction = position - static_cast<double>(below);
  return ascending[below] + fraction * (ascending[above] - ascending[below]);
}

ErrorStatistics statistics(std::vector<double> errors) {
  ErrorStatistics result;
  result.count = errors.size();
  if (errors.empty()) return result;
  const auto count = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());
  double sum = 0.0;
  for (const double error : errors) {
    sum += error;
    result.sse += error * error;
  }
  result.mean = sum / count;
  result.rmse = std::sqrt(result.sse / count);
  double squared_deviations = 0.0;
  for (const double error : errors) {
    squared_deviations += (error - result.mean) * (error - result.mean);
  }
  result.std = std::sqrt(squared_deviations / count);
  result.median = quantile(errors, 0.5);
  result.p95 = quantile(errors, 0.95);
  result.min = errors.front();
  result.max = errors.back();
  return result;
}

TrajectoryErrors trajectory_errors(const Trajectory& reference, const Trajectory& estimate,
                                   const TrajectoryErrorOptions& options) {
  PCAVR_REQUIRE(options.relative_step > 0.0, options.relative_step);
  const Duration step = duration_from_seconds(options.relative_step);
  const std::vector<MatchedPose> matched =
      match(reference, estimate, duration_from_seconds(options.max_gap));
  TrajectoryErrors errors;
  errors.unmatched = estimate.size() - matched.size();
  errors.T_reference_estimate = best_rigid_motion(matched);
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const MatchedPose& pair = matched[i];
    errors.absolute.push_back(error_between(pair.stamp, pair.reference, pair.estimate));
    if (errors.T_reference_estimate) {
      errors.absolute_aligned.push_back(
          error_between(pair.stamp, pair.reference, *errors.T_reference_estimate * pair.estimate));
    }
    if (i > 0) errors.step.push_back(error_of_motion(matched[i - 1], pair));
    const std::optional<std::size_t> later = one_step_later(matched, i, step);
    if (later) errors.relative.push_back(error_of_motion(pair, matched[*later]));
  }
  return errors;
}

std::vector<double> translations(const std::vector<PoseError>& errors) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const PoseError& error : errors) values.push_back(error.translation);
  return values;
}

std::vector<double> rotations(const std::vector<PoseError>& errors) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const PoseError& error : errors) values.push_back(error.rotation);
  return values;
}

}  // namespace pcavr
