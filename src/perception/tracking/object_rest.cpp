// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/tracking/object_rest.hpp"

#include <algorithm>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr::tracking {
namespace {

/// Window of the mean that is tested against the average: a sixth of a second at 30 Hz.
constexpr std::size_t kRecentWindow = 5;
/// Threshold of the squared Mahalanobis distance: false alarm rate of one in a million frames
/// (chi-square, six degrees of freedom).
constexpr double kChiSquareThreshold = 38.3;
/// Bounds of the variance factor: stds that are stated too large by 7 and too small by 2; beyond,
/// motion would be absorbed as noise.
constexpr double kMinVarianceFactor = 0.02;
constexpr double kMaxVarianceFactor = 4.0;
constexpr int kVarianceWindow = 60;  // measurements: the factor's own std is then some 7 %
/// Regularises the information of a measurement with unobservable directions: std of 1 m, 1 rad.
constexpr double kMinInformation = 1.0;

Matrix6d covariance_of(const Matrix6d& information) {
  const Matrix6d regular = information + kMinInformation * Matrix6d::Identity();
  return regular.ldlt().solve(Matrix6d::Identity());
}

/// Squared Mahalanobis distance.
double squared_distance(const Vector6d& difference, const Matrix6d& covariance) {
  return difference.dot(covariance.ldlt().solve(difference));
}

Matrix6d full_covariance(const PoseMeasurement& measurement) {
  return covariance_of(measurement.information) + measurement.camera_covariance;
}

}  // namespace

/// Covariance of the errors that averaging does not reduce.
Matrix6d RestFilter::floor_covariance() const {
  const double translation = options_.translation_floor_std;
  const double rotation = options_.rotation_floor_std;
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(rotation * rotation);
  return variances.asDiagonal();
}

void RestFilter::Average::add(const PoseMeasurement& measurement, int max_averaged) {
  if (count == 0) T_base_object = measurement.T_base_object;
  const Matrix6d own = full_covariance(measurement).ldlt().solve(Matrix6d::Identity());
  if (count >= max_averaged) information *= 1.0 - 1.0 / max_averaged;
  information += own;
  const Vector6d difference = (T_base_object.inverse() * measurement.T_base_object).log();
  T_base_object = T_base_object * Pose::exp(information.ldlt().solve(own * difference));
  ++count;
}

RestFilter::Average RestFilter::average_of_all() const {
  Average average = older_;
  for (const PoseMeasurement& measurement : recent_) {
    average.add(measurement, options_.max_averaged);
  }
  return average;
}

bool RestFilter::has_jumped(const PoseMeasurement& measurement) const {
  const Average average = average_of_all();
  if (average.count == 0) return false;
  const Vector6d difference = (average.T_base_object.inverse() * measurement.T_base_object).log();
  const Matrix6d covariance = variance_factor_ * (covariance_of(measurement.information) +
                                                  covariance_of(average.information)) +
                              measurement.camera_covariance + floor_covariance();
  return squared_distance(difference, covariance) > kChiSquareThreshold;
}

bool RestFilter::has_drifted() const {
  if (older_.count == 0) return false;
  Average recent;
  for (const PoseMeasurement& measurement : recent_) {
    recent.add(measurement, options_.max_averaged);
  }
  const Vector6d difference = (older_.T_base_object.inverse() * recent.T_base_object).log();
  const Matrix6d covariance =
      variance_factor_ * (covariance_of(recent.information) + covariance_of(older_.information)) +
      recent_.back().camera_covariance + floor_covariance();
  return squared_distance(difference, covariance) > kChiSquareThreshold;
}

void RestFilter::update_variance_factor(const PoseMeasurement& measurement) {
  if (!last_) return;
  const Vector6d difference = (last_->T_base_object.inverse() * measurement.T_base_object).log();
  const Matrix6d covariance = covariance_of(last_->information) +
                              covariance_of(measurement.information) +
                              measurement.camera_covariance;
  const double ratio = std::min(squared_distance(difference, covariance) / 6.0, kMaxVarianceFactor);
  variance_count_ = std::min(variance_count_ + 1, kVarianceWindow);
  // The initial value of 1 counts as one measurement.
  variance_factor_ += (ratio - variance_factor_) / (variance_count_ + 1.0);
  variance_factor_ = std::clamp(variance_factor_, kMinVarianceFactor, kMaxVarianceFactor);
}

void RestFilter::reset() {
  older_ = {};
  recent_.clear();
  jumps_ = 0;
}

RestFilter::Estimate RestFilter::add(const PoseMeasurement& measurement) {
  const Estimate unfiltered{measurement.T_base_object, full_covariance(measurement), false};
  if (has_jumped(measurement)) {
    last_.reset();
    if (++jumps_ < 2) return unfiltered;
    reset();
  } else {
    jumps_ = 0;
    update_variance_factor(measurement);
  }
  last_ = measurement;
  recent_.push_back(measurement);
  if (recent_.size() > kRecentWindow) {
    older_.add(recent_.front(), options_.max_averaged);
    recent_.pop_front();
  }
  if (has_drifted()) {
    reset();
    recent_.push_back(measurement);
  }
  return at_rest().value_or(unfiltered);
}

std::optional<RestFilter::Estimate> RestFilter::at_rest() const {
  const Average average = average_of_all();
  if (average.count < options_.min_count || jumps_ > 0) return std::nullopt;
  return Estimate{average.T_base_object, covariance_of(average.information) + floor_covariance(),
                  true};
}

}  // namespace pcavr::tracking
