// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tool_compliance.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <Eigen/LU>

namespace pcavr {
namespace {

constexpr double kSetpointTime = 0.5;   // [s] of setpoints that are kept for samples to come
constexpr double kSpeedTime = 0.01;     // [s] over which the setpoint's speed is taken
constexpr double kMaxSpeed = 0.15;      // [m/s] of a push: faster arms do not follow as stated
constexpr double kMinSpeed = 5e-4;      // [m/s] slower, there is no lag to be found
constexpr double kMinForceRate = 1.0;   // [N/s] slower, there is no delay to be found
constexpr double kAveragedTime = 0.2;   // [s] two swings of a slow arm
constexpr double kMeanTime = 1.0;       // [s] of the means that are left out
constexpr double kMinForce = 2.0;       // [N] a smaller change is mostly the sensor's noise
constexpr double kMaxSquares = 1000.0;  // [N^2 s] of forces that count: ten seconds at 10 N
constexpr double kMinTime = 0.2;        // [s] of contact before there is a value
// [s] An arm swings: what is left of neighbouring samples agrees for as long.
constexpr double kCorrelationTime = 0.05;
constexpr double kMaxRelativeStd = 0.3;

}  // namespace

void ToolCompliance::add_setpoint(double t, const Eigen::Vector3d& p_base) {
  if (!setpoints_.empty() && t <= setpoints_.back().t) return;
  setpoints_.push_back({t, p_base});
  while (setpoints_.front().t < t - kSetpointTime) setpoints_.pop_front();
}

/// In a straight line between two cycles.
std::optional<Eigen::Vector3d> ToolCompliance::setpoint_at(double t) const {
  const auto after =
      std::lower_bound(setpoints_.begin(), setpoints_.end(), t,
                       [](const Setpoint& setpoint, double wanted) { return setpoint.t < wanted; });
  if (after == setpoints_.begin() || after == setpoints_.end()) return std::nullopt;
  const Setpoint& before = *std::prev(after);
  const double share = (t - before.t) / (after->t - before.t);
  return before.p_base + share * (after->p_base - before.p_base);
}

void ToolCompliance::add_sample(double t, const Eigen::Vector3d& p_base_tip,
                                const Eigen::Vector3d& force_base) {
  const std::optional<Eigen::Vector3d> now = setpoint_at(t);
  const std::optional<Eigen::Vector3d> before = setpoint_at(t - kSpeedTime);
  const double dt = last_ ? t - *last_ : 0.0;
  last_ = t;
  if (!now || !before || !p_base_tip.allFinite() || !force_base.allFinite()) return;
  const Eigen::Vector3d v_base = (*now - *before) / kSpeedTime;
  const bool is_slow = v_base.norm() < kMaxSpeed;
  if (!(dt > 0.0) || dt > kSpeedTime || !is_slow) return forget_means();
  newest_.push_back({t, {*now - p_base_tip, force_base, v_base, Eigen::Vector3d::Zero()}});
  const std::optional<Row> row = averaged();
  if (!row) return;
  mean_time_ = std::min(mean_time_ + dt, kMeanTime);
  const double gain = dt / mean_time_;
  mean_.shortfall += gain * (row->shortfall - mean_.shortfall);
  mean_.force += gain * (row->force - mean_.force);
  mean_.speed += gain * (row->speed - mean_.speed);
  mean_.force_rate += gain * (row->force_rate - mean_.force_rate);
  const Row change{row->shortfall - mean_.shortfall, row->force - mean_.force,
                   row->speed - mean_.speed, row->force_rate - mean_.force_rate};
  if (change.force.norm() >= kMinForce) add(change, dt);
  while (newest_.front().t <= t - kAveragedTime) newest_.pop_front();
}

void ToolCompliance::forget_means() {
  newest_.clear();
  mean_time_ = 0.0;
}

std::optional<ToolCompliance::Row> ToolCompliance::averaged() const {
  const double span = newest_.back().t - newest_.front().t;
  if (span < kAveragedTime) return std::nullopt;
  const double middle = newest_.front().t + 0.5 * span;
  Row sum;
  Eigen::Vector3d late = Eigen::Vector3d::Zero();
  double count = 0.0, late_count = 0.0;
  double t_sum = 0.0, t_late = 0.0;
  for (const Sample& sample : newest_) {
    sum.shortfall += sample.row.shortfall;
    sum.force += sample.row.force;
    sum.speed += sample.row.speed;
    t_sum += sample.t;
    count += 1.0;
    if (sample.t <= middle) continue;
    late += sample.row.force;
    t_late += sample.t;
    late_count += 1.0;
  }
  const double early_count = count - late_count;
  const double apart = t_late / late_count - (t_sum - t_late) / early_count;
  const Eigen::Vector3d early = sum.force - late;
  return Row{sum.shortfall / count, sum.force / count, sum.speed / count,
             (late / late_count - early / early_count) / apart};
}

void ToolCompliance::add(const Row& row, double dt) {
  const double keep = std::max(0.0, 1.0 - dt * row.force.squaredNorm() / kMaxSquares);
  Eigen::Matrix3d causes;
  causes << row.force, row.speed, row.force_rate;
  normal_ = keep * normal_ + dt * causes.transpose() * causes;
  right_ = keep * right_ + dt * causes.transpose() * row.shortfall;
  squares_ = keep * squares_ + dt * row.shortfall.squaredNorm();
  time_ = keep * time_ + dt;
  if (time_ < kMinTime) return;
  Eigen::Matrix3d normal = normal_;
  normal(1, 1) += kMinSpeed * kMinSpeed * time_;
  normal(2, 2) += kMinForceRate * kMinForceRate * time_;
  const Eigen::Matrix3d inverse = normal.inverse();
  const Eigen::Vector3d found = inverse * right_;
  const double left = std::max(0.0, squares_ - found.dot(right_)) / (3.0 * time_);
  const double std = std::sqrt(left * kCorrelationTime * inverse(0, 0));
  if (found.x() > 0.0 && std < kMaxRelativeStd * found.x()) value_ = found.x();
}

}  // namespace pcavr
