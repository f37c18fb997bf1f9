// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/held_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include <fmt/format.h>

namespace pcavr {
namespace {

constexpr std::size_t kMaxColumns = 7;  // of a pose
using Row = std::array<double, kMaxColumns>;
/// The numbers of a row; columns that a stream does not have are 0.
using RowOf = std::function<Row(std::size_t row)>;

constexpr std::size_t kMinValues = 12;    ///< fewer show no pace
constexpr double kShortPercentile = 0.1;  ///< of the runs: the pace of the source, but for jitter
constexpr double kMaxShorter = 0.02;      ///< of the runs: a source changes no faster than its pace
constexpr double kMaxLonger = 0.4;        ///< of the runs: a value may stay for several periods
constexpr double kPaceTolerance = 0.5;    ///< [periods] of a run at the pace: jitter of two clocks
constexpr double kMaxSingleSteps = 0.5;   ///< of the changes: more are a coarse resolution
constexpr double kOneStep = 1.5;          ///< [smallest change] two steps are more

/// First rows of the values, and one past the last row.
std::vector<std::size_t> starts_of_values(std::size_t rows, const RowOf& row) {
  std::vector<std::size_t> starts{0};
  Row last = row(0);
  for (std::size_t i = 1; i < rows; ++i) {
    const Row current = row(i);
    if (current == last) continue;
    starts.push_back(i);
    last = current;
  }
  starts.push_back(rows);
  return starts;
}

/// [rows] for which each value stands, where nearly all stand for about as many. The first and the
/// last run may be cut.
std::optional<double> rows_per_value(const std::vector<std::size_t>& starts) {
  std::vector<std::size_t> runs;
  for (std::size_t i = 2; i + 1 < starts.size(); ++i) runs.push_back(starts[i] - starts[i - 1]);
  if (runs.size() < kMinValues) return std::nullopt;
  std::sort(runs.begin(), runs.end());
  const auto count = static_cast<double>(runs.size());
  const std::size_t pace = runs[static_cast<std::size_t>(kShortPercentile * count)];
  if (pace < 2) return std::nullopt;
  const auto tolerance = std::max<std::size_t>(
      1, static_cast<std::size_t>(kPaceTolerance * static_cast<double>(pace)));
  const std::size_t shortest = pace == 2 ? 2 : pace - std::min(tolerance, pace - 2);
  const auto first = std::lower_bound(runs.begin(), runs.end(), shortest);
  const auto last = std::upper_bound(first, runs.end(), pace + tolerance);
  if (static_cast<double>(first - runs.begin()) > kMaxShorter * count) return std::nullopt;
  if (static_cast<double>(runs.end() - last) > kMaxLonger * count) return std::nullopt;
  double sum = 0.0;
  for (auto run = first; run != last; ++run) sum += static_cast<double>(*run);
  return sum / static_cast<double>(last - first);
}

/// Whether most changes are one step of one column: a slow motion at a coarse resolution, whose
/// values repeat, too.
bool is_coarse(const std::vector<std::size_t>& starts, const RowOf& row) {
  const auto change = [&](std::size_t i) {
    const Row before = row(starts[i - 1]);
    Row difference = row(starts[i]);
    for (std::size_t k = 0; k < kMaxColumns; ++k)
      difference[k] = std::abs(difference[k] - before[k]);
    return difference;
  };
  Row smallest{};
  for (std::size_t i = 1; i + 1 < starts.size(); ++i) {
    const Row difference = change(i);
    for (std::size_t k = 0; k < kMaxColumns; ++k) {
      if (difference[k] > 0.0 && (smallest[k] == 0.0 || difference[k] < smallest[k])) {
        smallest[k] = difference[k];
      }
    }
  }
  std::size_t single_steps = 0;
  for (std::size_t i = 1; i + 1 < starts.size(); ++i) {
    const Row difference = change(i);
    std::size_t columns = 0;
    bool is_one_step = true;
    for (std::size_t k = 0; k < kMaxColumns; ++k) {
      columns += difference[k] > 0.0 ? 1 : 0;
      is_one_step = is_one_step && difference[k] <= kOneStep * smallest[k];
    }
    single_steps += columns == 1 && is_one_step ? 1 : 0;
  }
  return static_cast<double>(single_steps) > kMaxSingleSteps * static_cast<double>(starts.size());
}

/// The rows that begin a value, and one for each period inside a longer run.
std::vector<std::size_t> rows_to_keep(const std::vector<std::size_t>& starts, double period) {
  const auto stride = static_cast<std::size_t>(std::lround(period));
  const auto longest = static_cast<std::size_t>(std::lround((1.0 + kPaceTolerance) * period));
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    kept.push_back(starts[i]);
    if (starts[i + 1] - starts[i] <= longest) continue;
    for (std::size_t row = starts[i] + stride; row < starts[i + 1]; row += stride) {
      kept.push_back(row);
    }
  }
  return kept;
}

std::string note_of(const std::string& stream, double period, double duration, std::size_t rows,
                    std::size_t kept) {
  const double rate = static_cast<double>(rows - 1) / duration;
  return fmt::format(
      "{}: each value stands for {:.3g} rows: {:.3g} rows a second hold {:.3g} values a second; "
      "{} of {} rows, which repeat the row before, are left out",
      stream, period, rate, rate / period, rows - kept, rows);
}

template <typename Sample>
std::optional<std::string> leave_out(const std::string& stream, const RowOf& row,
                                     std::vector<Sample>& samples) {
  if (samples.size() < kMinValues) return std::nullopt;
  const std::vector<std::size_t> starts = starts_of_values(samples.size(), row);
  const std::optional<double> period = rows_per_value(starts);
  if (!period || is_coarse(starts, row)) return std::nullopt;
  const std::vector<std::size_t> kept = rows_to_keep(starts, *period);
  const double duration = to_seconds(samples.back().stamp - samples.front().stamp);
  std::string note = note_of(stream, *period, duration, samples.size(), kept.size());
  std::vector<Sample> left;
  left.reserve(kept.size());
  for (const std::size_t i : kept) left.push_back(samples[i]);
  samples = std::move(left);
  return note;
}

}  // namespace

std::optional<std::string> leave_out_held(const std::string& stream, Trajectory& poses) {
  std::vector<TimedPose> samples = poses.poses();
  const RowOf row = [&samples](std::size_t i) {
    const Eigen::Vector3d& p = samples[i].pose.translation();
    const Eigen::Quaterniond& q = samples[i].pose.rotation();
    return Row{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
  };
  std::optional<std::string> note = leave_out(stream, row, samples);
  if (note) poses = Trajectory(std::move(samples));
  return note;
}

std::optional<std::string> leave_out_held(const std::string& stream,
                                          std::vector<WrenchSample>& wrench) {
  const RowOf row = [&wrench](std::size_t i) {
    const Eigen::Vector3d& f = wrench[i].force;
    const Eigen::Vector3d& m = wrench[i].torque;
    return Row{f.x(), f.y(), f.z(), m.x(), m.y(), m.z(), 0.0};
  };
  return leave_out(stream, row, wrench);
}

}  // namespace pcavr
