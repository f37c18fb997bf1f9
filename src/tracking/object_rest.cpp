// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tracking/object_rest.hpp"

#include <algorithm>

#include <Eigen/Dense>

namespace pcavr::tracking {
namespace {

/// Measurements in the mean that is tested against the average: a sixth of a second at 30 Hz.
constexpr std::size_t kNewest = 5;
/// Measurements after which an object that has passed the tests is said to rest.
constexpr int kFirstRest = 5;
/// The squared Mahalanobis distance that chance exceeds once in a million frames (chi-square, six
/// degrees of freedom).
constexpr double kUnlikely = 38.3;
/// What an average of measurements is trusted to at best: lens, print and pixel grid err alike in
/// all frames. Motion below it is none.
constexpr double kRepeatability = 5e-5;      // [m]
constexpr double kTurnRepeatability = 2e-4;  // [rad]
/// Older measurements than these many are forgotten bit by bit.
constexpr double kMaxAveraged = 60.0;
/// How far the learnt scatter may lie from what the measurements claim.
constexpr double kMinScatter = 0.02;
constexpr double kMaxScatter = 4.0;
constexpr int kScatterMemory = 60;
/// Makes the information of a measurement that leaves a direction open invertible: 1 m, 1 rad.
constexpr double kNothingKnown = 1.0;

Matrix6d covariance_of(const Matrix6d& information) {
  const Matrix6d regular = information + kNothingKnown * Matrix6d::Identity();
  return regular.ldlt().solve(Matrix6d::Identity());
}

Matrix6d repeatability() {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(kRepeatability * kRepeatability),
      Eigen::Vector3d::Constant(kTurnRepeatability * kTurnRepeatability);
  return variances.asDiagonal();
}

double squared_distance(const Vector6d& off, const Matrix6d& covariance) {
  return off.dot(covariance.ldlt().solve(off));
}

Matrix6d full_covariance(const PoseMeasurement& measurement) {
  return covariance_of(measurement.information) + measurement.camera_covariance;
}

}  // namespace

void RestFilter::Average::add(const PoseMeasurement& measurement) {
  if (count == 0) T_base_object = measurement.T_base_object;
  const Matrix6d own = full_covariance(measurement).ldlt().solve(Matrix6d::Identity());
  if (count >= static_cast<int>(kMaxAveraged)) information *= 1.0 - 1.0 / kMaxAveraged;
  information += own;
  const Vector6d off = (T_base_object.inverse() * measurement.T_base_object).log();
  T_base_object = T_base_object * Pose::exp(information.ldlt().solve(own * off));
  ++count;
}

RestFilter::Average RestFilter::everything() const {
  Average average = old_;
  for (const PoseMeasurement& measurement : newest_) average.add(measurement);
  return average;
}

bool RestFilter::has_jumped(const PoseMeasurement& measurement) const {
  const Average average = everything();
  if (average.count == 0) return false;
  const Vector6d off = (average.T_base_object.inverse() * measurement.T_base_object).log();
  const Matrix6d covariance =
      scatter_ * (covariance_of(measurement.information) + covariance_of(average.information)) +
      measurement.camera_covariance + repeatability();
  return squared_distance(off, covariance) > kUnlikely;
}

bool RestFilter::has_crept() const {
  if (old_.count == 0) return false;
  Average recent;
  for (const PoseMeasurement& measurement : newest_) recent.add(measurement);
  const Vector6d off = (old_.T_base_object.inverse() * recent.T_base_object).log();
  const Matrix6d covariance =
      scatter_ * (covariance_of(recent.information) + covariance_of(old_.information)) +
      newest_.back().camera_covariance + repeatability();
  return squared_distance(off, covariance) > kUnlikely;
}

void RestFilter::learn_scatter(const PoseMeasurement& measurement) {
  if (!last_) return;
  const Vector6d off = (last_->T_base_object.inverse() * measurement.T_base_object).log();
  const Matrix6d covariance = covariance_of(last_->information) +
                              covariance_of(measurement.information) +
                              measurement.camera_covariance;
  const double ratio = std::min(squared_distance(off, covariance) / 6.0, kMaxScatter);
  scatter_count_ = std::min(scatter_count_ + 1, kScatterMemory);
  // The claim counts as one measurement among those learnt from.
  scatter_ += (ratio - scatter_) / (scatter_count_ + 1.0);
  scatter_ = std::clamp(scatter_, kMinScatter, kMaxScatter);
}

void RestFilter::start_anew() {
  old_ = {};
  newest_.clear();
  jumps_ = 0;
}

RestFilter::Estimate RestFilter::add(const PoseMeasurement& measurement) {
  const Estimate alone{measurement.T_base_object, full_covariance(measurement), false};
  if (has_jumped(measurement)) {
    last_.reset();
    if (++jumps_ < 2) return alone;
    start_anew();
  } else {
    jumps_ = 0;
    learn_scatter(measurement);
  }
  last_ = measurement;
  newest_.push_back(measurement);
  if (newest_.size() > kNewest) {
    old_.add(newest_.front());
    newest_.pop_front();
  }
  if (has_crept()) {
    start_anew();
    newest_.push_back(measurement);
  }
  return at_rest().value_or(alone);
}

std::optional<RestFilter::Estimate> RestFilter::at_rest() const {
  const Average average = everything();
  if (average.count < kFirstRest || jumps_ > 0) return std::nullopt;
  return Estimate{average.T_base_object, covariance_of(average.information) + repeatability(),
                  true};
}

}  // namespace pcavr::tracking
