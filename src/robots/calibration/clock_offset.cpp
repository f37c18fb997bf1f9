// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/clock_offset.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

constexpr double kMinHalfWindow = 0.05;   ///< [s] of a velocity: shorter ones are noise
constexpr double kWindowIntervals = 2.0;  ///< half of it, in intervals of the slower stream
/// Step of the velocities' slopes, in half windows: of shorter ones the noise would count as
/// motion, and the std would be too small.
constexpr double kDerivativeWindows = 2.0;
constexpr double kGapIntervals = 6.0;     ///< over which a stream is not interpolated
constexpr std::size_t kMaxCoarse = 3000;  ///< samples of the search over all offsets
constexpr std::size_t kMaxFine = 12000;   ///< samples of the estimate
/// Step of the estimate's samples, in intervals of the faster stream: by the golden section they
/// fall on all phases between its rows alike. On one phase alone the errors of interpolation at a
/// window's two ends differ by a part of the slope: 0.4 ms of offset at 50 Hz.
constexpr double kSampleStep = 0.618034;
constexpr std::size_t kMinSamples = 40;
constexpr std::size_t kPeaks = 4;  ///< of the search, each of which is refined
constexpr int kMaxClockSteps = 25;
/// Windows for the std, of this part of the record: longer ones are few, shorter ones mix the
/// frequencies of the motion with those of the noise.
constexpr double kParts = 12.0;
constexpr double kMinPartSteps = 5.0;   ///< of a window's length, in steps of the slopes
constexpr double kMinParts = 8.0;       ///< windows side by side
constexpr double kMinExplained = 0.5;   ///< less is no common motion
constexpr double kMaxStd = 0.1;         ///< [s] more says nothing
constexpr double kMinDriftSpan = 30.0;  ///< [s]
constexpr double kHuber = 2.5;          ///< [robust stds] beyond, residuals count linearly
/// Two offsets of which the second explains nearly as much are ambiguous.
constexpr double kMaxSecond = 0.9;

enum class Velocity { angular, linear };

/// A stream's velocity over a window about an instant.
class VelocitySignal {
 public:
  VelocitySignal(const PoseStream& stream, Velocity kind, double half_window, double slow_interval)
      : stream_(stream),
        kind_(kind),
        half_window_(half_window),
        max_gap_(duration_from_seconds(kGapIntervals * slow_interval)) {}

  [[nodiscard]] std::optional<Eigen::Vector3d> at(double t) const {
    const auto before = stream_.poses.at(Stamp::from_seconds(t - half_window_), max_gap_);
    const auto after = stream_.poses.at(Stamp::from_seconds(t + half_window_), max_gap_);
    if (!before || !after) return std::nullopt;
    const Eigen::Vector3d change =
        kind_ == Velocity::angular ? Eigen::Vector3d((before->inverse() * *after).log().tail<3>())
                                   : Eigen::Vector3d(after->translation() - before->translation());
    return Eigen::Vector3d(change / (2.0 * half_window_));
  }
  [[nodiscard]] double begin() const { return stream_.poses.poses().front().stamp.seconds(); }
  [[nodiscard]] double end() const { return stream_.poses.poses().back().stamp.seconds(); }

 private:
  const PoseStream& stream_;
  Velocity kind_;
  double half_window_;
  Duration max_gap_;
};

/// Norms of a signal on a grid; negative where it is not known.
std::vector<double> norms_on_grid(const VelocitySignal& signal, double step) {
  std::vector<double> norms;
  for (double t = signal.begin(); t <= signal.end(); t += step) {
    const auto value = signal.at(t);
    norms.push_back(value ? value->norm() : -1.0);
  }
  return norms;
}

/// Correlation of a[i + lag] with b[i]; 0 where too few are known.
double correlation_at(const std::vector<double>& a, const std::vector<double>& b,
                      std::ptrdiff_t lag, std::size_t min_count) {
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  const auto size_a = static_cast<std::ptrdiff_t>(a.size());
  const auto size_b = static_cast<std::ptrdiff_t>(b.size());
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, -lag); i < std::min(size_b, size_a - lag);
       ++i) {
    const double p = a[static_cast<std::size_t>(i + lag)], q = b[static_cast<std::size_t>(i)];
    if (p < 0.0 || q < 0.0) continue;
    n += 1.0, sum_a += p, sum_b += q, aa += p * p, bb += q * q, ab += p * q;
  }
  if (n < static_cast<double>(min_count)) return 0.0;
  const double var_a = aa - sum_a * sum_a / n, var_b = bb - sum_b * sum_b / n;
  if (!(var_a > 0.0) || !(var_b > 0.0)) return 0.0;
  return (ab - sum_a * sum_b / n) / std::sqrt(var_a * var_b);
}

/// The offsets with the highest correlations of the norms, which no turn changes: local maxima.
std::vector<double> candidate_offsets(const VelocitySignal& a, const VelocitySignal& b,
                                      double interval, double min_overlap) {
  const double span = std::max(a.end() - a.begin(), b.end() - b.begin());
  const double step = std::max(interval, span / static_cast<double>(kMaxCoarse));
  const std::vector<double> of_a = norms_on_grid(a, step), of_b = norms_on_grid(b, step);
  const auto known = [](const std::vector<double>& norms) {
    return std::count_if(norms.begin(), norms.end(), [](double norm) { return norm >= 0.0; });
  };
  const auto min_count = std::max<std::size_t>(
      kMinSamples / 2, static_cast<std::size_t>(
                           min_overlap * static_cast<double>(std::min(known(of_a), known(of_b)))));
  const auto first = -static_cast<std::ptrdiff_t>(of_b.size());
  std::vector<double> correlations;
  for (std::ptrdiff_t lag = first; lag < static_cast<std::ptrdiff_t>(of_a.size()); ++lag) {
    correlations.push_back(correlation_at(of_a, of_b, lag, min_count));
  }
  std::vector<std::pair<double, double>> peaks;  // correlation, offset
  for (std::size_t i = 1; i + 1 < correlations.size(); ++i) {
    if (correlations[i] <= 0.0 || correlations[i] < correlations[i - 1] ||
        correlations[i] < correlations[i + 1]) {
      continue;
    }
    const auto lag = static_cast<double>(first + static_cast<std::ptrdiff_t>(i));
    peaks.emplace_back(correlations[i], a.begin() - b.begin() + lag * step);
  }
  std::sort(peaks.rbegin(), peaks.rend());
  std::vector<double> offsets;
  for (const auto& [correlation, offset] : peaks) {
    if (offsets.size() < kPeaks) offsets.push_back(offset);
  }
  return offsets;
}

/// b's velocities, at instants of its own clock, and what a's are then.
struct Samples {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> b;
};

Samples samples_of(const VelocitySignal& b, double interval) {
  const double step =
      std::max(kSampleStep * interval, (b.end() - b.begin()) / static_cast<double>(kMaxFine));
  Samples samples;
  for (double t = b.begin(); t <= b.end(); t += step) {
    const auto value = b.at(t);
    if (!value) continue;
    samples.t.push_back(t);
    samples.b.push_back(*value);
  }
  return samples;
}

/// The turn R that minimises the sum of |a - R b|^2 [Kabsch 1976].
Eigen::Matrix3d turn_between(const std::vector<Eigen::Vector3d>& a,
                             const std::vector<Eigen::Vector3d>& b,
                             const std::vector<double>& weights) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) sum += weights[i] * a[i] * b[i].transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

/// The estimate about one candidate: turn, offset and drift by Gauss-Newton.
class ClockFit {
 public:
  ClockFit(const VelocitySignal& a, const Samples& samples, double derivative_step, bool with_drift)
      : a_(a), samples_(samples), derivative_step_(derivative_step), with_drift_(with_drift) {
    clock_.middle = 0.5 * (samples.t.front() + samples.t.back());
  }

  [[nodiscard]] ClockOffset fit(double offset) {
    clock_.offset = offset;
    if (with_drift_) clock_.drift = 0.0;
    for (int i = 0; i < kMaxClockSteps; ++i) {
      if (!look_up()) return clock_;
      const Eigen::VectorXd step = solve();
      clock_.offset += step[0];
      if (with_drift_) *clock_.drift += step[1];
      if (std::abs(step[0]) < 1e-7) break;
    }
    if (!look_up()) return clock_;
    (void)solve();
    state_std();
    return clock_;
  }

 private:
  /// a's velocities and their slopes at the samples, by the present clock.
  bool look_up() {
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
    return at_.size() >= kMinSamples;
  }

  /// One step of offset, drift and turn; keeps rows and residuals.
  Eigen::VectorXd solve() {
    if (weights_.size() != at_.size()) weights_.assign(at_.size(), 1.0);
    const Eigen::Matrix3d R = turn_between(a_values_, b_values_, weights_);
    const Eigen::Index columns = with_drift_ ? 5 : 4;
    normal_ = Eigen::MatrixXd::Zero(columns, columns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
    residuals_.clear(), rows_.clear();
    for (std::size_t i = 0; i < at_.size(); ++i) {
      const Eigen::Vector3d turned = R * b_values_[i];
      Eigen::Matrix<double, 3, Eigen::Dynamic> row(3, columns);
      row.col(0) = slopes_[i];
      if (with_drift_) row.col(1) = (at_[i] - clock_.middle) * slopes_[i];
      row.rightCols<3>() = skew(turned);  // of a further turn of b, with its sign
      residuals_.emplace_back(a_values_[i] - turned);
      rows_.push_back(row);
      normal_ += weights_[i] * row.transpose() * row;
      right -= weights_[i] * row.transpose() * residuals_[i];
    }
    weigh();
    return normal_.ldlt().solve(right);
  }

  /// Weights by Huber's loss, from the residuals' median.
  void weigh() {
    std::vector<double> norms;
    for (const Eigen::Vector3d& residual : residuals_) norms.push_back(residual.norm());
    const double unit = kHuber * std::max(median(std::move(norms)), 1e-9);
    for (std::size_t i = 0; i < residuals_.size(); ++i) {
      const double norm = residuals_[i].norm();
      weights_[i] = norm > unit ? unit / norm : 1.0;
    }
  }

  /// Std by the long-run variance of the score: the scatter of overlapping parts of the record
  /// under Hann's window [Welch 1967]. Velocities are differences of poses, whose noise is strong
  /// at high frequencies and weak at those of the motion: parts with sharp ends would mix the two,
  /// and give 1.5 times the std.
  void state_std() {
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
    const Eigen::MatrixXd inverse =
        normal_.ldlt().solve(Eigen::MatrixXd::Identity(columns, columns));
    const Eigen::MatrixXd covariance = inverse * score_variance(length) * inverse;
    clock_.std = std::sqrt(std::max(covariance(0, 0), 0.0));
    if (with_drift_) clock_.drift_std = std::sqrt(std::max(covariance(1, 1), 0.0));
    clock_.is_observable = clock_.explained > kMinExplained && clock_.std > 0.0 &&
                           clock_.std < kMaxStd && span >= kMinParts * length;
  }

  /// Variance of the sum of all samples' scores, from windows of this length [s].
  [[nodiscard]] Eigen::MatrixXd score_variance(double length) const {
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

  const VelocitySignal& a_;
  const Samples& samples_;
  double derivative_step_;
  bool with_drift_;
  ClockOffset clock_;
  std::vector<double> at_, weights_;
  std::vector<Eigen::Vector3d> a_values_, b_values_, slopes_, residuals_;
  std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> rows_;
  Eigen::MatrixXd normal_;
};

/// The best of the candidates, or the reason why none can be chosen.
ClockOffset best_offset(const PoseStream& a, const PoseStream& b, Velocity kind,
                        const ClockOffsetOptions& options) {
  const double interval = std::max(a.interval(), b.interval());
  const double half_window = std::max(kWindowIntervals * interval, kMinHalfWindow);
  const VelocitySignal of_a(a, kind, half_window, interval), of_b(b, kind, half_window, interval);
  const Samples samples = samples_of(of_b, std::min(a.interval(), b.interval()));
  ClockOffset best, second;
  if (samples.t.size() < kMinSamples) {
    best.reason = "too few samples";
    return best;
  }
  const double derivative_step = kDerivativeWindows * half_window;
  for (const double offset : candidate_offsets(of_a, of_b, interval, options.min_overlap)) {
    ClockOffset found = ClockFit(of_a, samples, derivative_step, false).fit(offset);
    const bool is_new = std::abs(found.offset - best.offset) > half_window;
    if (found.explained > best.explained) {
      if (is_new) second = best;
      best = std::move(found);
    } else if (is_new && found.explained > second.explained) {
      second = std::move(found);
    }
  }
  if (best.is_observable && second.is_observable &&
      second.explained > kMaxSecond * best.explained) {
    best.is_observable = false;
    best.reason = fmt::format("the motion repeats: {:.3f} s and {:.3f} s fit alike", best.offset,
                              second.offset);
  }
  if (!best.is_observable) return best;
  if (options.is_drift_estimated && best.overlap > kMinDriftSpan) {
    ClockOffset drifting = ClockFit(of_a, samples, derivative_step, true).fit(best.offset);
    if (drifting.is_observable) return drifting;
  }
  return best;
}

}  // namespace

ClockOffset estimate_clock_offset(const PoseStream& a, const PoseStream& b,
                                  const ClockOffsetOptions& options) {
  if (a.poses.size() < kMinSamples || b.poses.size() < kMinSamples) {
    return {.reason = fmt::format("one stream has less than {} poses", kMinSamples)};
  }
  ClockOffset rotation = best_offset(a, b, Velocity::angular, options);
  if (rotation.is_observable) return rotation;
  // Of a body that turns, the two frames' origins have different velocities.
  const ClockOffset shift = best_offset(a, b, Velocity::linear, options);
  if (shift.is_observable) return shift;
  if (rotation.reason.empty()) {
    rotation.reason = "the streams have no common motion that turns or speeds up";
  }
  return rotation;
}

std::vector<HandEyeView> paired_views(const PoseStream& a, const PoseStream& b,
                                      const ClockOffset& clock, std::size_t max_views) {
  const Duration max_gap = duration_from_seconds(kGapIntervals * a.interval());
  std::vector<HandEyeView> views;
  for (const TimedPose& of_b : b.poses.poses()) {
    const auto of_a =
        a.poses.at(Stamp::from_seconds(clock.corrected(of_b.stamp.seconds())), max_gap);
    if (!of_a) continue;
    views.push_back({"t = " + format_stamp(of_b.stamp, 3), *of_a, of_b.pose});
  }
  if (views.size() <= max_views) return views;
  std::vector<HandEyeView> spread;
  for (std::size_t i = 0; i < max_views; ++i) {
    spread.push_back(std::move(views[i * views.size() / max_views]));
  }
  return spread;
}

}  // namespace pcavr
