// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/sample_clock.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

constexpr double kMinSpeedShare = 0.2;   ///< of the rms speed: slower rows show no interval
constexpr double kMaxFraction = 0.12;    ///< [ticks] of an interval beyond a whole number
constexpr double kMinWholeShare = 0.95;  ///< of the intervals must be whole multiples
constexpr double kMinJitter = 0.05;      ///< [ticks] rms; below it the stamps are right
constexpr double kMaxDrift = 5.0;        ///< [ticks] of the corrected stamps from the read ones
constexpr double kDriftAverage = 0.01;   ///< weight of a row in the mean difference of both clocks

/// Intervals between rows that position increments and velocities imply, where the arm is fast
/// enough.
std::vector<std::optional<double>> implied_intervals(const JointLog& log) {
  const Eigen::Index rows = log.position.rows();
  const double power = log.velocity.squaredNorm() / static_cast<double>(rows);
  std::vector<std::optional<double>> intervals(static_cast<std::size_t>(rows) - 1);
  for (Eigen::Index i = 0; i + 1 < rows; ++i) {
    const Eigen::RowVectorXd speed = 0.5 * (log.velocity.row(i) + log.velocity.row(i + 1));
    const double square = speed.squaredNorm();
    if (square < kMinSpeedShare * kMinSpeedShare * power || square == 0.0) continue;
    const double travel = (log.position.row(i + 1) - log.position.row(i)).dot(speed);
    intervals[static_cast<std::size_t>(i)] = travel / square;
  }
  return intervals;
}

/// The cycle, where nearly all implied intervals are whole multiples of it.
std::optional<double> tick_of(const std::vector<std::optional<double>>& intervals) {
  std::vector<double> known;
  for (const auto& interval : intervals) {
    if (interval) known.push_back(*interval);
  }
  if (2 * known.size() < intervals.size()) return std::nullopt;
  const double tick = median(known);
  if (!(tick > 0.0)) return std::nullopt;
  const auto whole = std::count_if(known.begin(), known.end(), [&](double interval) {
    return std::abs(interval / tick - std::round(interval / tick)) < kMaxFraction;
  });
  if (static_cast<double>(whole) < kMinWholeShare * static_cast<double>(known.size())) {
    return std::nullopt;
  }
  return tick;
}

void keep_rows(const std::vector<std::size_t>& rows, JointLog& log) {
  const auto keep = [&](Eigen::MatrixXd& values) {
    if (values.rows() == 0) return;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      values.row(static_cast<Eigen::Index>(i)) = values.row(static_cast<Eigen::Index>(rows[i]));
    }
    values.conservativeResize(static_cast<Eigen::Index>(rows.size()), Eigen::NoChange);
  };
  keep(log.position);
  keep(log.velocity);
  keep(log.torque);
  keep(log.current);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    log.t[i] = log.t[rows[i]];
    log.lines[i] = log.lines[rows[i]];
    log.stamps[i] = log.stamps[rows[i]];
  }
  log.t.resize(rows.size());
  log.lines.resize(rows.size());
  log.stamps.resize(rows.size());
}

}  // namespace

SampleClock correct_sample_clock(JointLog& log) {
  SampleClock clock;
  if (log.velocity.rows() < 100) return clock;
  const std::vector<std::optional<double>> intervals = implied_intervals(log);
  const std::optional<double> tick = tick_of(intervals);
  if (!tick) return clock;
  std::vector<double> corrected{0.0};
  std::vector<std::size_t> kept{0};
  double lead = 0.0, max_drift = 0.0, jitter = 0.0;
  std::size_t repeated = 0, skipped = 0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double read = log.t[i + 1] - log.t[0];
    // A slow row shows no interval of its own: it follows the stamps.
    const double ticks = intervals[i]
                             ? std::round(*intervals[i] / *tick)
                             : std::max(0.0, std::round((read - lead - corrected.back()) / *tick));
    if (!(ticks >= 0.0)) return clock;
    corrected.push_back(corrected.back() + ticks * *tick);
    const double drift = (read - corrected.back() - lead) / *tick;
    max_drift = std::max(max_drift, std::abs(drift));
    lead += kDriftAverage * (read - corrected.back() - lead);
    const double error = (log.t[i + 1] - log.t[i]) / *tick - ticks;
    jitter += error * error;
    if (ticks == 0.0) {
      ++repeated;
    } else {
      skipped += static_cast<std::size_t>(ticks) - 1;
      kept.push_back(i + 1);
    }
  }
  jitter = std::sqrt(jitter / static_cast<double>(intervals.size()));
  if (jitter < kMinJitter || max_drift > kMaxDrift) return clock;
  // The cycle from both ends of the log: the median of the intervals has their noise.
  const double stretch = (log.t.back() - log.t.front()) / corrected.back();
  for (std::size_t i = 0; i < corrected.size(); ++i) log.t[i] = corrected[i] * stretch;
  keep_rows(kept, log);
  return {.is_corrected = true, .tick = *tick * stretch, .repeated = repeated, .skipped = skipped};
}

}  // namespace pcavr
