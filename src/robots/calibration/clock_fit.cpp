// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "clock_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

/// Step of the velocities' slopes, in half windows: of shorter ones the noise would count as
/// motion, and the std would be too small.
constexpr double kDerivativeWindows = 2.0;
constexpr int kMaxClockSteps = 25;
constexpr double kConverged = 1e-6;  ///< [s]
/// Windows for the std, of this part of the record: longer ones are few, shorter ones mix the
/// frequencies of the motion with those of the noise.
constexpr double kParts = 12.0;
constexpr double kMinPartSteps = 5.0;  ///< of a window's length, in steps of the slopes
constexpr double kMinParts = 8.0;      ///< windows side by side
constexpr double kMinExplained = 0.5;  ///< less is no common motion
constexpr double kMaxStd = 0.1;        ///< [s] more says nothing
constexpr double kHuber = 2.5;         ///< [robust stds] beyond, residuals count linearly

}  // namespace

ClockFit::ClockFit(const VelocitySignal& a, const VelocitySamples& samples)
    : a_(a), samples_(samples), derivative_step_(kDerivativeWindows * a.half_window()) {}

ClockOffset ClockFit::fit(const ClockOffset& start) {
  clock_ = {.offset = start.offset,
            .drift = start.drift,
            .middle = 0.5 * (samples_.t.front() + samples_.t.back()),
            .step = start.step};
  const double half_span = 0.5 * (samples_.t.back() - samples_.t.front());
  for (int i = 0; i < kMaxClockSteps; ++i) {
    if (!look_up()) return clock_;
    const Eigen::VectorXd step = solve();
    apply(step);
    double change = std::abs(step[0]);
    if (clock_.drift) change = std::max(change, half_span * std::abs(step[drift_column()]));
    if (clock_.step) change = std::max(change, std::abs(step[step_column()]));
    if (change < kConverged) break;
  }
  if (!look_up()) return clock_;
  (void)solve();
  state_std();
  return clock_;
}

void ClockFit::apply(const Eigen::VectorXd& step) {
  clock_.offset += step[0];
  if (clock_.drift) *clock_.drift += step[drift_column()];
  if (clock_.step) clock_.step->size += step[step_column()];
}

/// a's velocities and their slopes at the samples, by the present clock.
bool ClockFit::look_up() {
  at_.clear(), a_values_.clear(), b_values_.clear(), slopes_.clear();
  for (std::size_t i = 0; i < samples_.t.size(); ++i) {
    const double t = clock_.corrected(samples_.t[i]);
    const auto value = a_.at(t), before = a_.at(t - derivative_step_),
               after = a_.at(t + derivative_step_);
    if (!value || !before || !after) continue;
    at_.push_back(samples_.t[i]);
    a_values_.push_back(*value);
    b_values_.push_back(samples_.b[i]);
    slopes_.emplace_back((*after - *before) / (2.0 * derivative_step_));
  }
  return at_.size() >= kMinClockSamples;
}

/// One step of offset, drift, step and turn; keeps rows and residuals.
Eigen::VectorXd ClockFit::solve() {
  if (weights_.size() != at_.size()) weights_.assign(at_.size(), 1.0);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < at_.size(); ++i) {
    sum += weights_[i] * a_values_[i] * b_values_[i].transpose();
  }
  const Eigen::Matrix3d R = turn_of(sum);
  const Eigen::Index columns = 4 + (clock_.drift ? 1 : 0) + (clock_.step ? 1 : 0);
  normal_ = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
  residuals_.clear(), rows_.clear();
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const Eigen::Vector3d turned = R * b_values_[i];
    Eigen::Matrix<double, 3, Eigen::Dynamic> row(3, columns);
    row.col(0) = slopes_[i];
    if (clock_.drift) row.col(drift_column()) = (at_[i] - clock_.middle) * slopes_[i];
    if (clock_.step) row.col(step_column()) = clock_.step->is_after(at_[i]) * slopes_[i];
    row.rightCols<3>() = skew(turned);  // of a further turn of b, with its sign
    residuals_.emplace_back(a_values_[i] - turned);
    rows_.push_back(row);
    normal_ += weights_[i] * row.transpose() * row;
    right -= weights_[i] * row.transpose() * residuals_[i];
  }
  weigh();
  return normal_.ldlt().solve(right);
}

double ClockFit::loss_unit() const {
  std::vector<double> norms;
  norms.reserve(residuals_.size());
  for (const Eigen::Vector3d& residual : residuals_) norms.push_back(residual.norm());
  return kHuber * std::max(median(std::move(norms)), 1e-9);
}

/// Weights by Huber's loss, from the residuals' median.
void ClockFit::weigh() {
  const double unit = loss_unit();
  for (std::size_t i = 0; i < residuals_.size(); ++i) {
    const double norm = residuals_[i].norm();
    weights_[i] = norm > unit ? unit / norm : 1.0;
  }
}

double ClockFit::mean_loss(double unit) const {
  double sum = 0.0;
  for (const Eigen::Vector3d& residual : residuals_) {
    const double norm = residual.norm();
    sum += norm > unit ? unit * (2.0 * norm - unit) : norm * norm;
  }
  return sum / static_cast<double>(std::max<std::size_t>(residuals_.size(), 1));
}

double ClockFit::step_information() const {
  const Eigen::Index n = normal_.rows();
  const Eigen::MatrixXd inverse = normal_.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  const double variance = inverse(step_column(), step_column());
  return variance > 0.0 ? 1.0 / (variance * static_cast<double>(at_.size())) : 0.0;
}

/// Std by the long-run variance of the score: the scatter of overlapping parts of the record
/// under Hann's window [Welch 1967]. Velocities are differences of poses, whose noise is strong
/// at high frequencies and weak at those of the motion: parts with sharp ends would mix the two,
/// and give 1.5 times the std.
void ClockFit::state_std() {
  const double span = at_.back() - at_.front();
  const double length = std::max(span / kParts, kMinPartSteps * derivative_step_);
  const Eigen::Index columns = normal_.rows();
  double motion = 0.0, rest = 0.0;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    motion += weights_[i] * a_values_[i].squaredNorm();
    rest += weights_[i] * residuals_[i].squaredNorm();
    clock_.residual.push_back(residuals_[i].norm());
  }
  clock_.residual_t = at_;
  clock_.samples = at_.size();
  clock_.overlap = span;
  clock_.explained = motion > 0.0 ? 1.0 - rest / motion : 0.0;
  const Eigen::MatrixXd inverse = normal_.ldlt().solve(Eigen::MatrixXd::Identity(columns, columns));
  const Eigen::MatrixXd of_score = score_variance(length);
  const Eigen::MatrixXd covariance = inverse * of_score * inverse;
  const auto std_of = [&](Eigen::Index i) { return std::sqrt(std::max(covariance(i, i), 0.0)); };
  // Drift and step are shown by a few windows: by the noise of the whole record, if that is more.
  const double noise = of_score(0, 0) / normal_(0, 0);
  const auto std_by_few = [&](Eigen::Index i) {
    return std::max(std_of(i), std::sqrt(noise * std::max(inverse(i, i), 0.0)));
  };
  clock_.std = std_of(0);
  if (clock_.drift) clock_.drift_std = std_by_few(drift_column());
  if (clock_.step) clock_.step->std = std_by_few(step_column());
  clock_.is_observable = clock_.explained > kMinExplained && clock_.std > 0.0 &&
                         clock_.std < kMaxStd && span >= kMinParts * length;
}

/// Variance of the sum of all samples' scores, from windows of this length [s].
Eigen::MatrixXd ClockFit::score_variance(double length) const {
  const Eigen::Index columns = normal_.rows();
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(columns, columns);
  double squares = 0.0;  // of the windows' weights
  std::size_t first = 0;
  for (double begin = at_.front(); begin + 0.99 * length <= at_.back(); begin += 0.5 * length) {
    while (at_[first] < begin) ++first;
    Eigen::VectorXd part = Eigen::VectorXd::Zero(columns);
    for (std::size_t i = first; i < at_.size() && at_[i] < begin + length; ++i) {
      const double sine = std::sin(std::numbers::pi * (at_[i] - begin) / length);
      const double window = sine * sine;
      part += window * weights_[i] * rows_[i].transpose() * residuals_[i];
      squares += window * window;
    }
    scatter += part * part.transpose();
  }
  return scatter * (static_cast<double>(at_.size()) / squares);
}

}  // namespace pcavr
