// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tool_response.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

constexpr double kKeptTime = 0.5;          // [s] of signals that are kept for samples to come
constexpr double kMaxSampleGap = 0.01;     // [s] between samples
constexpr double kMaxSpeed = 0.15;         // [m/s] of a push: faster arms do not follow as stated
constexpr double kMinSpeed = 5e-4;         // [m/s] slower, there is no lag to be found
constexpr double kMinAcceleration = 0.02;  // [m/s^2] likewise
constexpr double kMeanTime = 1.0;          // [s] of the means that are left out
constexpr double kMinForce = 2.0;          // [N] a smaller change is mostly the sensor's noise
constexpr double kMaxSquares = 1000.0;     // [N^2 s] of forces that count: ten seconds at 10 N
constexpr double kMemory = 60.0;           // [s] of other motion that counts
constexpr double kSettlingTime = 0.5;      // [s] after a gap: of the slowest oscillator
constexpr double kMinTime = 0.2;           // [s] of contact before there is a value
constexpr double kSolutionInterval = 0.1;  // [s]
// [s] What an arm does beside the model agrees in neighbouring samples for as long.
constexpr double kCorrelationTime = 0.05;
constexpr double kMaxRelativeStd = 0.3;

// Servos: 5 to 40 Hz.
constexpr double kMinFrequency = 5.0;  // [Hz]
constexpr double kFrequencyFactor = 1.12;
constexpr int kFrequencies = 20;
constexpr double kMinDampingRatio = 0.5;
constexpr double kDampingFactor = 1.2;
constexpr int kDampingRatios = 6;

double median(double a, double b, double c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

/// A function's values on 3 x 3 points of a grid, as its Taylor series about the middle one, by
/// central differences; in steps of the grid.
template <typename Value>
struct Quadratic {
  Value middle, du, dv, duu, duv, dvv;

  /// `at(i, j)`, i and j from -1 to 1.
  template <typename At>
  explicit Quadratic(const At& at)
      : middle(at(0, 0)),
        du((at(1, 0) - at(-1, 0)) / 2.0),
        dv((at(0, 1) - at(0, -1)) / 2.0),
        duu(at(1, 0) - 2.0 * middle + at(-1, 0)),
        duv((at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / 4.0),
        dvv(at(0, 1) - 2.0 * middle + at(0, -1)) {}

  [[nodiscard]] Value at(const Eigen::Vector2d& p) const {
    const double u = p.x(), v = p.y();
    return middle + u * du + v * dv + 0.5 * u * u * duu + u * v * duv + 0.5 * v * v * dvv;
  }
};

/// The minimum within the grid's points; the middle one where the function has no minimum.
Eigen::Vector2d minimum_of(const Quadratic<double>& function) {
  Eigen::Matrix2d hessian;
  hessian << function.duu, function.duv, function.duv, function.dvv;
  if (!(function.duu > 0.0) || !(hessian.determinant() > 0.0)) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d minimum = -hessian.inverse() * Eigen::Vector2d(function.du, function.dv);
  return minimum.cwiseMax(-1.0).cwiseMin(1.0);
}

}  // namespace

ToolResponse::ToolResponse() {
  double frequency = kMinFrequency;
  for (int i = 0; i < kFrequencies; ++i, frequency *= kFrequencyFactor) {
    double ratio = kMinDampingRatio;
    for (int j = 0; j < kDampingRatios; ++j, ratio *= kDampingFactor) {
      oscillators_.push_back({2.0 * std::numbers::pi * frequency, ratio});
    }
  }
}

void ToolResponse::add_setpoint(double t, const Eigen::Vector3d& p_base) {
  if (!p_base.allFinite() || (!setpoints_.empty() && t <= setpoints_.back().t)) return;
  setpoints_.push_back({t, p_base});
  while (setpoints_.front().t < t - kKeptTime) setpoints_.pop_front();
}

/// Removes single spikes: a force without a shortfall would make the arm stiffer.
void ToolResponse::add_force(double t, const Eigen::Vector3d& force_base) {
  if (!force_base.allFinite() || (last_force_ && t <= *last_force_)) return;
  raw_forces_.push_back(force_base);
  if (raw_forces_.size() > 3) raw_forces_.pop_front();
  const std::optional<double> t_middle = std::exchange(last_force_, t);
  if (raw_forces_.size() < 3) return;
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = median(raw_forces_[0][axis], raw_forces_[1][axis], raw_forces_[2][axis]);
  }
  forces_.push_back({*t_middle, middle});
  while (forces_.front().t < *t_middle - kKeptTime) forces_.pop_front();
}

void ToolResponse::add_tip(double t, const Eigen::Vector3d& p_base_tip) {
  if (!p_base_tip.allFinite() || (!tips_.empty() && t <= tips_.back().t)) return;
  tips_.push_back({t, p_base_tip});
  for (; !tips_.empty(); tips_.pop_front()) {
    const Timed& tip = tips_.front();
    const bool is_covered = !setpoints_.empty() && !forces_.empty() &&
                            setpoints_.back().t >= tip.t && forces_.back().t >= tip.t;
    if (!is_covered && tip.t > t - kKeptTime) return;
    const std::optional<Eigen::Vector3d> setpoint = at(setpoints_, tip.t);
    const std::optional<Eigen::Vector3d> force = at(forces_, tip.t);
    if (setpoint && force) process(tip, *setpoint, *force);
  }
}

/// Interpolates in a straight line between two samples.
std::optional<Eigen::Vector3d> ToolResponse::at(const std::deque<Timed>& signal, double t) {
  const auto after =
      std::lower_bound(signal.begin(), signal.end(), t,
                       [](const Timed& sample, double wanted) { return sample.t < wanted; });
  if (after == signal.begin() || after == signal.end()) return std::nullopt;
  const Timed& before = *std::prev(after);
  if (after->t - before.t > kMaxSampleGap) return std::nullopt;
  const double share = (t - before.t) / (after->t - before.t);
  return before.value + share * (after->value - before.value);
}

void ToolResponse::process(const Timed& tip, const Eigen::Vector3d& setpoint,
                           const Eigen::Vector3d& force) {
  const double dt = last_ ? tip.t - *last_ : 0.0;
  last_ = tip.t;
  const double speed = dt > 0.0 ? (setpoint - last_setpoint_).norm() / dt : 0.0;
  last_setpoint_ = setpoint;
  if (!(dt > 0.0) || dt > kMaxSampleGap) return restart(setpoint, force);
  for (Oscillator& oscillator : oscillators_) {
    oscillator.advance(oscillator.force, force, dt);
    oscillator.advance(oscillator.setpoint, setpoint, dt);
  }
  continuous_ += dt;
  if (continuous_ > kSettlingTime) add_rows(setpoint - tip.value, speed, dt);
  if (pressed_ < kMinTime || tip.t < next_solution_) return;
  next_solution_ = tip.t + kSolutionInterval;
  solve();
}

void ToolResponse::restart(const Eigen::Vector3d& setpoint, const Eigen::Vector3d& force) {
  continuous_ = 0.0;
  for (Oscillator& oscillator : oscillators_) {
    oscillator.force = {force};
    oscillator.setpoint = {setpoint};
  }
}

/// The trapezoidal rule: exact to 1 % up to 20 Hz at 500 samples a second.
void ToolResponse::Oscillator::advance(Filtered& signal, const Eigen::Vector3d& input,
                                       double dt) const {
  const double h = 0.5 * dt;
  const double square = rate * rate;
  const double damping = 2.0 * damping_ratio * rate;
  const Eigen::Vector3d begin = signal.value + h * signal.rate;
  const Eigen::Vector3d pushed =
      signal.rate + h * signal.acceleration + h * square * (input - begin);
  signal.rate = pushed / (1.0 + damping * h + square * h * h);
  signal.value = begin + h * signal.rate;
  signal.acceleration = square * (input - signal.value) - damping * signal.rate;
}

Eigen::Matrix3d ToolResponse::Oscillator::regressors() const {
  Eigen::Matrix3d columns;
  columns << force.value, setpoint.rate, setpoint.acceleration;
  return columns;
}

void ToolResponse::add_rows(const Eigen::Vector3d& shortfall, double speed, double dt) {
  const double gain = dt / std::min(continuous_ - kSettlingTime, kMeanTime);
  mean_shortfall_ += gain * (shortfall - mean_shortfall_);
  const Eigen::Vector3d change = shortfall - mean_shortfall_;
  const bool is_slow = speed < kMaxSpeed;
  double keep = 1.0;
  if (is_slow) {
    const Eigen::Vector3d force = oscillators_.back().force.value - oscillators_.back().mean.col(0);
    if (force.norm() >= kMinForce) pressed_ += dt;
    keep = std::max(0.0, 1.0 - dt / kMemory - dt * force.squaredNorm() / kMaxSquares);
  }
  for (Oscillator& oscillator : oscillators_) {
    const Eigen::Matrix3d causes = oscillator.regressors();
    oscillator.mean += gain * (causes - oscillator.mean);
    if (!is_slow) continue;
    const Eigen::Matrix3d changes = causes - oscillator.mean;
    oscillator.normal = keep * oscillator.normal + dt * changes.transpose() * changes;
    oscillator.right = keep * oscillator.right + dt * changes.transpose() * change;
  }
  if (!is_slow) return;
  squares_ = keep * squares_ + dt * change.squaredNorm();
  time_ = keep * time_ + dt;
}

ToolResponse::Fit ToolResponse::fit(const Oscillator& oscillator) const {
  Eigen::Matrix3d normal = oscillator.normal;
  normal(1, 1) += kMinSpeed * kMinSpeed * time_;
  normal(2, 2) += kMinAcceleration * kMinAcceleration * time_;
  Fit fit;
  fit.inverse = normal.inverse();
  fit.found = fit.inverse * oscillator.right;
  fit.left = squares_ - fit.found.dot(oscillator.right);
  return fit;
}

/// Solves between the grid's points by one step of Newton's method.
void ToolResponse::solve() {
  std::vector<Fit> fits;
  for (const Oscillator& oscillator : oscillators_) fits.push_back(fit(oscillator));
  const auto best = std::min_element(fits.begin(), fits.end(),
                                     [](const Fit& a, const Fit& b) { return a.left < b.left; }) -
                    fits.begin();
  const auto index = static_cast<int>(best);
  const int row = std::clamp(index / kDampingRatios, 1, kFrequencies - 2);
  const int column = std::clamp(index % kDampingRatios, 1, kDampingRatios - 2);
  const auto position = [&](int i, int j) {
    const int at = (row + i) * kDampingRatios + column + j;
    return static_cast<std::size_t>(at);
  };
  const auto fit_at = [&](int i, int j) -> const Fit& { return fits[position(i, j)]; };
  const Eigen::Vector2d minimum =
      minimum_of(Quadratic<double>([&](int i, int j) { return fit_at(i, j).left; }));
  const Eigen::Vector3d found =
      Quadratic<Eigen::Vector3d>([&](int i, int j) { return fit_at(i, j).found; }).at(minimum);
  const Oscillator& middle = oscillators_[position(0, 0)];
  const TipResponse response{
      .compliance = found.x(),
      .rate = middle.rate * std::pow(kFrequencyFactor, minimum.x()),
      .damping_ratio = middle.damping_ratio * std::pow(kDampingFactor, minimum.y()),
      .lag = found.y(),
      .acceleration_lag = found.z()};
  const Fit& nearest = fits[static_cast<std::size_t>(best)];
  const double variance = std::max(nearest.left, 0.0) / (3.0 * time_);
  const double std = std::sqrt(variance * kCorrelationTime * nearest.inverse(0, 0));
  const bool is_known = response.compliance > 0.0 && std < kMaxRelativeStd * response.compliance;
  if (is_known && is_plausible(response)) value_ = response;
}

}  // namespace pcavr
