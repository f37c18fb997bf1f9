// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/joint_signals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"

#include "robots/robot_identification/spectrum.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinRows = 8;
constexpr double kMotionPowerShare = 0.99999;
constexpr double kNoiseMargin = 20.0;  ///< over the mean level of noise: its peaks stay below
constexpr double kAutomaticBandwidthOverRate = 0.1;  ///< differences are exact to 0.1 % there
constexpr double kMaxBandwidthOverRate = 0.4;        ///< the bilinear transform needs less than 0.5

/// One section of second order, in the transposed direct form II.
class Biquad {
 public:
  /// Low-pass with gain 1; `cutoff` over the rate, quality by the Butterworth polynomial.
  Biquad(double cutoff, double quality) {
    const double k = std::tan(std::numbers::pi * cutoff);
    const double norm = 1.0 / (1.0 + k / quality + k * k);
    b0_ = k * k * norm;
    b1_ = 2.0 * b0_;
    a1_ = 2.0 * (k * k - 1.0) * norm;
    a2_ = (1.0 - k / quality + k * k) * norm;
  }

  /// Filters in place; begins in the steady state of the first value.
  void run(Eigen::VectorXd& values) const {
    double z1 = values[0] * (1.0 - b0_);
    double z2 = values[0] * (b0_ - a2_);
    for (double& value : values) {
      const double y = b0_ * value + z1;
      z1 = b1_ * value - a1_ * y + z2;
      z2 = b0_ * value - a2_ * y;
      value = y;
    }
  }

 private:
  double b0_, b1_, a1_, a2_;
};

/// The values, continued on both sides by `extra` point-reflected ones.
Eigen::VectorXd continued(const Eigen::VectorXd& values, Eigen::Index extra) {
  const Eigen::Index count = values.size();
  Eigen::VectorXd longer(count + 2 * extra);
  longer.segment(extra, count) = values;
  for (Eigen::Index i = 1; i <= extra; ++i) {
    longer[extra - i] = 2.0 * values[0] - values[i];
    longer[extra + count - 1 + i] = 2.0 * values[count - 1] - values[count - 1 - i];
  }
  return longer;
}

std::vector<double> uniform_grid(const std::vector<double>& t, double interval) {
  const auto count = static_cast<std::size_t>(std::floor((t.back() - t.front()) / interval)) + 1;
  std::vector<double> grid(count);
  for (std::size_t i = 0; i < count; ++i) {
    grid[i] = t.front() + interval * static_cast<double>(i);
  }
  return grid;
}

double median_interval(const std::vector<double>& t) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
  return median(intervals);
}

/// Whether each instant of the grid is at least `margin` away from the ends and from gaps.
std::vector<bool> usable(const std::vector<double>& t, const std::vector<double>& grid,
                         double margin, double max_gap) {
  std::vector<bool> is_usable(grid.size(), true);
  const auto exclude = [&](double from, double to) {
    const auto first = std::lower_bound(grid.begin(), grid.end(), from) - grid.begin();
    const auto last = std::upper_bound(grid.begin(), grid.end(), to) - grid.begin();
    for (auto i = first; i < last; ++i) is_usable[static_cast<std::size_t>(i)] = false;
  };
  exclude(grid.front(), grid.front() + margin);
  exclude(grid.back() - margin, grid.back());
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (t[i] - t[i - 1] > max_gap) exclude(t[i - 1] - margin, t[i] + margin);
  }
  return is_usable;
}

/// Excludes stretches of more than `max_rest` rows in which all joints rest; returns their rows.
std::size_t exclude_rest(const Eigen::MatrixXd& velocity, std::size_t max_rest,
                         std::vector<bool>& is_usable) {
  constexpr double kRestShare = 0.01;  // of the rms of the sum of all speeds
  const Eigen::VectorXd speed = velocity.rowwise().norm();
  const double limit =
      kRestShare * std::sqrt(speed.squaredNorm() / static_cast<double>(speed.size()));
  std::size_t excluded = 0, begin = 0;
  for (std::size_t i = 0; i <= is_usable.size(); ++i) {
    if (i < is_usable.size() && speed[static_cast<Eigen::Index>(i)] < limit) continue;
    if (i - begin > max_rest) {
      for (std::size_t k = begin; k < i; ++k) is_usable[k] = false;
      excluded += i - begin;
    }
    begin = i + 1;
  }
  return excluded;
}

std::size_t nearest_row(const std::vector<double>& t, double at) {
  const auto after = std::lower_bound(t.begin(), t.end(), at);
  if (after == t.begin()) return 0;
  const auto index = static_cast<std::size_t>(after - t.begin());
  if (after == t.end()) return t.size() - 1;
  return *after - at < at - t[index - 1] ? index : index - 1;
}

Eigen::MatrixXd resampled(const std::vector<double>& t, const Eigen::MatrixXd& values,
                          const std::vector<double>& grid) {
  Eigen::MatrixXd on_grid(static_cast<Eigen::Index>(grid.size()), values.cols());
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    on_grid.col(j) = interpolate(t, values.col(j), grid);
  }
  return on_grid;
}

Eigen::MatrixXd selected_rows(const Eigen::MatrixXd& values, const std::vector<std::size_t>& rows) {
  Eigen::MatrixXd selected(static_cast<Eigen::Index>(rows.size()), values.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    selected.row(static_cast<Eigen::Index>(i)) = values.row(static_cast<Eigen::Index>(rows[i]));
  }
  return selected;
}

/// Signals of the whole log on the grid, filtered.
struct GridSignals {
  Eigen::MatrixXd q, dq, ddq, tau;
};

Eigen::MatrixXd filtered(Eigen::MatrixXd values, double rate, double bandwidth) {
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    values.col(j) = filter_zero_phase(values.col(j), rate, bandwidth);
  }
  return values;
}

Eigen::MatrixXd differentiated(const Eigen::MatrixXd& values, double interval) {
  Eigen::MatrixXd rates(values.rows(), values.cols());
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    rates.col(j) = differentiate(values.col(j), interval);
  }
  return rates;
}

/// The time [s] by which the recorded velocities are later than the positions' derivative: the
/// least-squares shift, to first order around `shift`.
double lag_step(const Eigen::MatrixXd& recorded, const GridSignals& grid) {
  const double slope = grid.ddq.squaredNorm();
  return slope > 0.0 ? (grid.dq - recorded).cwiseProduct(grid.ddq).sum() / slope : 0.0;
}

/// Mean square of what a signal has above `bandwidth`.
double noise_power(const Eigen::MatrixXd& values, double rate, double bandwidth) {
  return (values - filtered(values, rate, bandwidth)).squaredNorm();
}

/// Uses the recorded velocities, their lag removed, where they agree with the positions and are
/// less noisy: stamps with jitter cost the positions' derivative, not them.
void use_recorded_velocity(const JointLog& log, const std::vector<double>& grid, double interval,
                           JointSignals& signals, GridSignals& on_grid) {
  constexpr int kLagSteps = 4;
  constexpr double kMaxLag = 0.05;           // [s] longer ones are faults, not filters
  constexpr double kMaxDisagreement = 0.05;  // of the rms speed
  const double rate = 1.0 / interval;
  Eigen::MatrixXd recorded;
  double lag = 0.0;
  for (int step = 0; step <= kLagSteps; ++step) {
    std::vector<double> at = grid;
    for (double& t : at) t += lag;
    recorded = filtered(resampled(log.t, log.velocity, at), rate, signals.bandwidth);
    if (step == kLagSteps) break;
    lag += lag_step(recorded, on_grid);
    if (!(std::abs(lag) < kMaxLag)) return;
  }
  signals.velocity_lag = lag;
  signals.velocity_disagreement = (recorded - on_grid.dq).norm() / on_grid.dq.norm();
  if (*signals.velocity_disagreement > kMaxDisagreement) return;
  const Eigen::MatrixXd acceleration = differentiated(recorded, interval);
  const double low = 0.5 * signals.bandwidth;
  if (noise_power(acceleration, rate, low) >= noise_power(on_grid.ddq, rate, low)) return;
  on_grid.dq = recorded;
  on_grid.ddq = acceleration;
  signals.is_velocity_recorded = true;
}

}  // namespace

Eigen::VectorXd filter_zero_phase(const Eigen::VectorXd& values, double rate, double bandwidth) {
  PCAVR_REQUIRE(bandwidth > 0.0 && 2.0 * bandwidth < rate, bandwidth, rate);
  if (values.size() < 2) return values;
  // Poles of the Butterworth polynomial of order 4 at 22.5 and 67.5 degrees.
  const std::array<Biquad, 2> sections{
      Biquad(bandwidth / rate, 0.5 / std::cos(std::numbers::pi / 8.0)),
      Biquad(bandwidth / rate, 0.5 / std::cos(3.0 * std::numbers::pi / 8.0))};
  const auto settling = static_cast<Eigen::Index>(std::ceil(3.0 * rate / bandwidth));
  const Eigen::Index extra = std::min(values.size() - 1, settling);
  Eigen::VectorXd filtered = continued(values, extra);
  for (int pass = 0; pass < 2; ++pass) {
    for (const Biquad& section : sections) section.run(filtered);
    filtered.reverseInPlace();
  }
  return filtered.segment(extra, values.size());
}

Eigen::VectorXd differentiate(const Eigen::VectorXd& values, double interval) {
  const Eigen::Index count = values.size();
  PCAVR_REQUIRE(count >= 2 && interval > 0.0, count, interval);
  Eigen::VectorXd rate(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index room = std::min(i, count - 1 - i);
    const auto pair = [&](Eigen::Index k) { return values[i + k] - values[i - k]; };
    if (room >= 3) {
      rate[i] = (45.0 * pair(1) - 9.0 * pair(2) + pair(3)) / 60.0;
    } else if (room >= 1) {
      rate[i] = 0.5 * pair(1);
    } else {
      rate[i] = i == 0 ? values[1] - values[0] : values[count - 1] - values[count - 2];
    }
  }
  return rate / interval;
}

Eigen::VectorXd interpolate(const std::vector<double>& t, const Eigen::VectorXd& values,
                            const std::vector<double>& at) {
  PCAVR_REQUIRE(t.size() >= 2 && static_cast<Eigen::Index>(t.size()) == values.size(), t.size());
  const auto last = static_cast<Eigen::Index>(t.size()) - 1;
  const auto time = [&](Eigen::Index i) { return t[static_cast<std::size_t>(i)]; };
  const auto slope = [&](Eigen::Index i) {
    const Eigen::Index a = std::max<Eigen::Index>(i - 1, 0), b = std::min(i + 1, last);
    return (values[b] - values[a]) / (time(b) - time(a));
  };
  Eigen::VectorXd result(static_cast<Eigen::Index>(at.size()));
  Eigen::Index i = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    while (i + 1 < last && time(i + 1) <= at[k]) ++i;
    const double width = time(i + 1) - time(i);
    const double s = std::clamp((at[k] - time(i)) / width, 0.0, 1.0);
    const double r = 1.0 - s;
    result[static_cast<Eigen::Index>(k)] = r * r * (1.0 + 2.0 * s) * values[i] +
                                           s * s * (1.0 + 2.0 * r) * values[i + 1] +
                                           width * s * r * (r * slope(i) - s * slope(i + 1));
  }
  return result;
}

double motion_frequency(const Eigen::MatrixXd& position, double interval) {
  Eigen::VectorXd power;
  double step = 0.0;
  for (Eigen::Index j = 0; j < position.cols(); ++j) {
    const Spectrum spectrum = power_spectrum(position.col(j), interval);
    step = spectrum.step;
    // The level of white noise is that of the upper half of the frequencies.
    const Eigen::Index count = spectrum.power.size();
    const Eigen::VectorXd upper = spectrum.power.tail(count / 2);
    const double noise = kNoiseMargin * upper.mean();
    if (power.size() == 0) power.setZero(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      power[k] += std::max(0.0, spectrum.power[k] - noise);
    }
  }
  double sum = 0.0;
  for (Eigen::Index k = 0; k < power.size(); ++k) {
    sum += power[k];
    if (sum >= kMotionPowerShare * power.sum()) return step * static_cast<double>(k + 1);
  }
  return step * static_cast<double>(power.size());
}

JointSignals joint_signals(const JointLog& log, const JointSignalOptions& options) {
  PCAVR_REQUIRE(log.t.size() >= kMinRows, log.t.size());
  const double interval = median_interval(log.t);
  const double rate = 1.0 / interval;
  const std::vector<double> grid = uniform_grid(log.t, interval);
  const Eigen::MatrixXd position = resampled(log.t, log.position, grid);
  JointSignals signals;
  signals.log_interval = interval;
  signals.motion_frequency = motion_frequency(position, interval);
  signals.bandwidth = options.bandwidth > 0.0
                          ? options.bandwidth
                          : std::min(options.bandwidth_of_motion * signals.motion_frequency,
                                     kAutomaticBandwidthOverRate * rate);
  signals.bandwidth = std::min(signals.bandwidth, kMaxBandwidthOverRate * rate);
  GridSignals on_grid{.q = filtered(position, rate, signals.bandwidth),
                      .dq = {},
                      .ddq = {},
                      .tau = filtered(resampled(log.t, log.torque, grid), rate, signals.bandwidth)};
  on_grid.dq = differentiated(on_grid.q, interval);
  on_grid.ddq = differentiated(on_grid.dq, interval);
  if (log.velocity.rows() > 0) {
    use_recorded_velocity(log, grid, interval, signals, on_grid);
  }
  const auto stride = static_cast<std::size_t>(
      std::max(1.0, std::floor(rate / (options.rows_per_period * signals.bandwidth))));
  std::vector<bool> is_usable =
      usable(log.t, grid, 1.0 / signals.bandwidth, std::max(options.max_gap, 2.5 * interval));
  signals.rows_at_rest = exclude_rest(
      on_grid.dq, static_cast<std::size_t>(std::ceil(options.max_rest * rate)), is_usable);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < grid.size(); i += stride) {
    if (!is_usable[i]) continue;
    rows.push_back(i);
    signals.t.push_back(grid[i]);
    signals.lines.push_back(log.lines[nearest_row(log.t, grid[i])]);
  }
  signals.interval = interval * static_cast<double>(stride);
  signals.position = selected_rows(on_grid.q, rows);
  signals.velocity = selected_rows(on_grid.dq, rows);
  signals.acceleration = selected_rows(on_grid.ddq, rows);
  signals.torque = selected_rows(on_grid.tau, rows);
  signals.torque_rate = selected_rows(differentiated(on_grid.tau, interval), rows);
  for (std::size_t k = 0; k < kSmoothingSpeeds.size(); ++k) {
    const Eigen::MatrixXd sign = (on_grid.dq.array() / kSmoothingSpeeds[k]).tanh();
    signals.smoothed_sign[k] = selected_rows(filtered(sign, rate, signals.bandwidth), rows);
  }
  for (std::size_t k = 0; k < kPreslidingDisplacements.size(); ++k) {
    Eigen::MatrixXd sign(on_grid.q.rows(), on_grid.q.cols());
    for (Eigen::Index j = 0; j < sign.cols(); ++j) {
      sign.col(j) = presliding_sign(on_grid.q.col(j), kPreslidingDisplacements[k]);
    }
    signals.presliding_sign[k] = selected_rows(filtered(sign, rate, signals.bandwidth), rows);
  }
  return signals;
}

}  // namespace pcavr
