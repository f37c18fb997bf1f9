// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/clock_shift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "physics/inputs/stream_gaps.hpp"

namespace pcavr {
namespace {

constexpr double kGridInterval = 0.05;  // [s] shorter than a contact
constexpr double kMaxShift = 60.0;      // [s]; a larger one would be another recording
/// Overlap at a shift, as a share of the shorter stream.
constexpr double kMinShared = 0.5;
/// A single contact matches any other of its length.
constexpr std::size_t kMinContacts = 2;
// Minimum correlation of a shift, and its margin over other shifts.
constexpr double kDecisive = 0.8;
constexpr double kLead = 0.15;
/// Errors of meshes and poses of a millimetre or two shift the touch by some tenths of a second:
/// sound laboratory recordings of slow pushes reach 0.6.
constexpr double kMaxAsWritten = 0.4;
/// Similar pushes match each other: then there is a shift, but its size is ambiguous.
constexpr double kClearLead = 0.5;
/// Closer shifts belong to the same peak; smaller ones are estimated and removed by force_offset.
constexpr double kSamePeak = 1.0;          // [s]
constexpr double kEstimatedOffset = 0.25;  // [s] search range of force_offset
/// A tip closer than this to a surface may touch it: poses and meshes have errors of millimetres.
constexpr double kTouchRange = 0.003;  // [m]

/// A tip that rests beside an object may touch it or not: it says nothing. Faster than the noise of
/// arms and trackers.
constexpr double kMoving = 0.002;  // [m/s]

/// Of two clocks' rates: speeds, and what is identified by them, are off by as much.
constexpr double kMaxDrift = 0.01;

/// Samples on a uniform grid from `start` on; NaN where nothing is known.
struct Signal {
  double start = 0.0;  ///< [s]
  std::vector<double> values;

  [[nodiscard]] double t(std::size_t k) const {
    return start + kGridInterval * static_cast<double>(k);
  }
  void leave_out(const std::vector<StreamGap>& gaps) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (is_in_gap(gaps, t(k))) values[k] = std::numeric_limits<double>::quiet_NaN();
    }
  }
};

std::size_t grid_size(double from, double to) {
  return static_cast<std::size_t>(std::floor((to - from) / kGridInterval)) + 1;
}

/// A signal that is 1 where the tip is at a surface or in it, 0 where it is kTouchRange away.
Signal touching(const InputSeries& series, const PathView& tip, const BodyPoses& poses) {
  Signal signal{series.t_tool.front(), {}};
  const std::size_t count = grid_size(series.t_tool.front(), series.t_tool.back());
  for (std::size_t k = 0; k < count; ++k) {
    const double t = signal.t(k);
    double value = 0.0;
    for (std::size_t i = 0; i < series.bodies.size(); ++i) {
      const double gap = poses.touch(i, t, tip.at(t), series.tool_radius).gap;
      value = std::max(value, std::clamp(1.0 - gap / kTouchRange, 0.0, 1.0));
    }
    signal.values.push_back(value);
  }
  signal.leave_out(stream_gaps(series.t_tool));
  return signal;
}

/// The same with NaN where the tip rests within that range.
Signal without_rests(Signal touch, const PathView& tip) {
  for (std::size_t k = 0; k < touch.values.size(); ++k) {
    const double t = touch.t(k);
    const Eigen::Vector3d way = tip.at(t) - tip.at(t - kGridInterval);
    if (touch.values[k] > 0.0 && way.norm() < kMoving * kGridInterval) {
      touch.values[k] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return touch;
}

/// A signal that is 1 while the force shows contact.
Signal loaded(const InputSeries& series, const Segmentation& found) {
  Signal signal{series.t_force.front(), {}};
  signal.values.assign(grid_size(series.t_force.front(), series.t_force.back()), 0.0);
  for (const Contact& contact : found.contacts) {
    for (std::size_t k = 0; k < signal.values.size(); ++k) {
      const double t = signal.t(k);
      if (t >= contact.begin && t <= contact.end) signal.values[k] = 1.0;
    }
  }
  signal.leave_out(stream_gaps(series.t_force));
  return signal;
}

/// Pearson correlation of a[i] and b[i + lag] over their overlap, without those that are NaN;
/// nothing where too few are left, or one of them is constant.
std::optional<double> correlation(const std::vector<double>& a, const std::vector<double>& b,
                                  std::ptrdiff_t lag) {
  const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, -lag);
  const std::ptrdiff_t end = std::min(std::ssize(a), std::ssize(b) - lag);
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::ptrdiff_t i = begin; i < end; ++i) {
    const double x = a[static_cast<std::size_t>(i)];
    const double y = b[static_cast<std::size_t>(i + lag)];
    if (std::isnan(x) || std::isnan(y)) continue;
    n += 1.0, sum_a += x, sum_b += y, aa += x * x, bb += y * y, ab += x * y;
  }
  const auto clear = std::count_if(a.begin(), a.end(), [](double x) { return !std::isnan(x); });
  if (n < kMinShared * static_cast<double>(std::min(clear, std::ssize(b)))) return std::nullopt;
  const double square = (aa - sum_a * sum_a / n) * (bb - sum_b * sum_b / n);
  if (!(square > 0.0)) return std::nullopt;
  return (ab - sum_a * sum_b / n) / std::sqrt(square);
}

struct Match {
  double shift = 0.0;  ///< [s] delay of the force
  double correlation = 0.0;
};

std::vector<Match> match_all(const Signal& touch, const Signal& load) {
  const auto lags = static_cast<std::ptrdiff_t>(kMaxShift / kGridInterval);
  // The time shift at a lag of 0.
  const double zero = load.start - touch.start;
  const auto middle = static_cast<std::ptrdiff_t>(std::llround(-zero / kGridInterval));
  std::vector<Match> matches;
  for (std::ptrdiff_t lag = middle - lags; lag <= middle + lags; ++lag) {
    const auto value = correlation(touch.values, load.values, lag);
    if (value) matches.push_back({zero + kGridInterval * static_cast<double>(lag), *value});
  }
  return matches;
}

double max_correlation_if(const std::vector<Match>& matches, const auto& is_counted) {
  double max_correlation = -1.0;  // the minimum of a correlation
  for (const Match& match : matches) {
    if (is_counted(match)) max_correlation = std::max(max_correlation, match.correlation);
  }
  return max_correlation;
}

struct ShiftedClock {
  Match best;
  double as_written = 0.0;  ///< correlation
  bool is_only_shift = false;
};

std::optional<ShiftedClock> shifted_clock(const Signal& touch, const Signal& load) {
  const std::vector<Match> matches = match_all(touch, load);
  if (matches.empty()) return std::nullopt;
  const Match best = *std::max_element(
      matches.begin(), matches.end(),
      [](const Match& a, const Match& b) { return a.correlation < b.correlation; });
  const double as_written = max_correlation_if(
      matches, [](const Match& m) { return std::abs(m.shift) <= kEstimatedOffset; });
  const double second_best = max_correlation_if(
      matches, [&](const Match& m) { return std::abs(m.shift - best.shift) > kSamePeak; });
  const double gain = best.correlation - as_written;
  const bool is_only_shift = best.correlation - second_best >= kLead;
  const bool is_fault = best.correlation >= kDecisive && std::abs(best.shift) > kEstimatedOffset &&
                        as_written <= kMaxAsWritten && (is_only_shift || gain >= kClearLead);
  if (!is_fault) return std::nullopt;
  return ShiftedClock{best, as_written, is_only_shift};
}

InputFault clock_fault_of(std::string message) {
  return {InputFaultKind::clock,
          {.message = std::move(message), .file = "wrench.csv", .hint = "put both on one clock"}};
}

}  // namespace

InputFault touch_fault(const TimeOffset& delay) {
  return clock_fault_of(fmt::format(
      "the force is {:.2f} +- {:.2f} s {} than the tool's motion: shifted by that, the tip leaves "
      "the surfaces where it touched them",
      std::abs(delay.offset), delay.std, delay.offset > 0.0 ? "later" : "earlier"));
}

std::optional<InputFault> drift_fault(const ClockDrift& drift) {
  if (std::abs(drift.rate) < kMaxDrift) return std::nullopt;
  return clock_fault_of(fmt::format(
      "its clock is {:.2g} +- {:.2g} % {} than the tool's, as the delay between force and motion "
      "changes from contact to contact; which of them is right is not known",
      1e2 * std::abs(drift.rate), 1e2 * drift.rate_std, drift.rate > 0.0 ? "faster" : "slower"));
}

std::optional<InputFault> clock_fault(const InputSeries& series, const Segmentation& found,
                                      const PathView& tip, const BodyPoses& poses) {
  if (found.contacts.size() < kMinContacts || series.bodies.empty()) return std::nullopt;
  const Signal touch = touching(series, tip, poses);
  const Signal load = loaded(series, found);
  const auto clock = shifted_clock(touch, load);
  if (!clock || !shifted_clock(without_rests(touch, tip), load)) return std::nullopt;
  if (!clock->is_only_shift) {
    return clock_fault_of(fmt::format(
        "the force does not show contact when the tip is at an object (correlation {:.2f}). It "
        "would by several shifts, such as {:.1f} s ({:.2f}), which is ambiguous",
        clock->as_written, clock->best.shift, clock->best.correlation));
  }
  return clock_fault_of(fmt::format(
      "the force is about {:.1f} s {} than the tool's motion: shifted by that, it shows contact "
      "when the tip is at an object (correlation {:.2f}, as written {:.2f})",
      std::abs(clock->best.shift), clock->best.shift > 0.0 ? "later" : "earlier",
      clock->best.correlation, clock->as_written));
}

}  // namespace pcavr
