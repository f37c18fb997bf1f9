// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/stream_faults.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

using Values = MeasuredStream::Values;

constexpr double kLever = 0.1;  ///< [m] of the points of a frame, by which its turn counts
constexpr std::size_t kMinStreamRows = 60;  ///< fewer show no usual interval
constexpr std::size_t kMaxOdd = 4;          ///< intervals: more are jitter
constexpr double kMinOdd = 5e-3;            ///< [s] from the usual interval
constexpr double kMinOddShare = 0.3;        ///< [usual intervals]
constexpr double kMinOddScatters = 5.0;     ///< of the other intervals' distance from the usual one
constexpr double kSide = 0.08;              ///< [s] of motion that is fitted on either side
constexpr std::size_t kMinSide = 4, kMaxSide = 25;  ///< [rows]
constexpr std::size_t kMaxCompared = 400;           ///< places that show how well a motion goes on
constexpr double kErrorShare = 0.68;  ///< of these places, whose error counts as a std
constexpr double kMinStds = 4.0;      ///< that rule out a cause
constexpr double kMaxStds = 6.0;      ///< with which a cause explains the motion
constexpr double kMaxCatchUp = 2.0;   ///< of the motion that a held stretch has left out: a jump
constexpr std::size_t kMinHeld = 3;   ///< [rows] together: fewer are chance
constexpr std::size_t kAround = 3;    ///< changes before and after, which show the motion
constexpr std::size_t kMaxHeld = 10;  ///< [rows] of noise: more may be a rest
/// Small changes that the one after a held stretch exceeds: a slow motion at a coarse resolution
/// repeats its values, too, and goes on by one step of it.
constexpr double kMinSteps = 1.5;
constexpr double kSmallShare = 0.25, kLargeShare = 0.9;  ///< of the changes are smaller
constexpr double kMinMotion =
    0.1;  ///< of a large change: less is a rest, whose changes say nothing
constexpr double kMaxResting = 0.5;  ///< of all rows: more repeat, and the stream is coarse
/// Of a change from that before, over the change: 1.7 of white noise, 0 of a motion.
constexpr double kMinNoiseBend = 1.2;
constexpr double kMinDistinct = 0.5;  ///< of the changes: fewer are steps of a resolution

/// The `share` quantile; 0 of nothing.
double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

/// Place and rate at row 0 of the rows that begin at `first`, by a straight line.
struct FittedLine {
  Values place = Values::Zero(), rate = Values::Zero();  ///< rate [1/s]
};

/// How a stream's values go on over an interval, as if its rows were a usual interval apart.
class Motion {
 public:
  Motion(const MeasuredStream& stream, double usual)
      : stream_(stream),
        usual_(usual),
        side_(std::clamp(static_cast<std::size_t>(kSide / usual), kMinSide, kMaxSide)) {}

  [[nodiscard]] bool is_inside(std::size_t row, std::size_t rows_on) const {
    return row + 1 >= side_ && row + rows_on + side_ <= stream_.values.size();
  }
  /// Time for which the values went on from a row to the one `rows_on` after it [s], and speed.
  struct Passed {
    double time = 0.0, speed = 0.0;
    Values jump = Values::Zero(), rate = Values::Zero();
  };
  [[nodiscard]] Passed between(std::size_t row, std::size_t rows_on) const {
    const FittedLine before = line(row + 1 - side_, static_cast<double>(side_ - 1));
    const FittedLine after = line(row + rows_on, 0.0);
    Passed passed{.jump = after.place - before.place, .rate = 0.5 * (before.rate + after.rate)};
    passed.speed = passed.rate.norm();
    if (passed.speed > 0.0)
      passed.time = passed.jump.dot(passed.rate) / (passed.speed * passed.speed);
    return passed;
  }
  /// The error of the place after so many rows, at about this speed elsewhere.
  [[nodiscard]] double error(std::size_t rows_on, double speed) const {
    std::vector<double> errors;
    const std::size_t stride = stream_.values.size() / kMaxCompared + 1;
    for (std::size_t row = 0; row < stream_.values.size(); row += stride) {
      if (!is_inside(row, rows_on)) continue;
      const Passed passed = between(row, rows_on);
      if (passed.speed < 0.5 * speed || passed.speed > 2.0 * speed) continue;
      errors.push_back(
          (passed.jump - passed.rate * (static_cast<double>(rows_on) * usual_)).norm());
    }
    return quantile_of(std::move(errors), kErrorShare);
  }

 private:
  /// Of side_ rows from `first` on; its place is at row first + `at`.
  [[nodiscard]] FittedLine line(std::size_t first, double at) const {
    const double middle = 0.5 * static_cast<double>(side_ - 1);
    FittedLine fit;
    double squares = 0.0;
    for (std::size_t i = 0; i < side_; ++i) {
      const double k = static_cast<double>(i) - middle;
      fit.place += stream_.values[first + i] / static_cast<double>(side_);
      fit.rate += k * stream_.values[first + i];
      squares += k * k;
    }
    fit.rate /= squares;
    fit.place += (at - middle) * fit.rate;
    fit.rate /= usual_;
    return fit;
  }

  const MeasuredStream& stream_;
  double usual_;
  std::size_t side_;
};

void judge(const MeasuredStream& stream, std::size_t row, OddInterval& odd) {
  const Motion motion(stream, odd.usual);
  if (stream.values.empty() || !motion.is_inside(row, 1)) return;
  const Motion::Passed passed = motion.between(row, 1);
  if (!(passed.speed > 0.0)) return;
  const auto rows_on =
      static_cast<std::size_t>(std::max(1.0, std::round(odd.interval / odd.usual)));
  const double of_step = motion.error(1, passed.speed) / passed.speed;
  const double of_loss = motion.error(rows_on, passed.speed) / passed.speed;
  if (!(of_step > 0.0) || !(of_loss > 0.0)) return;
  const double from_step = std::abs(passed.time - odd.usual);
  const double from_loss = std::abs(passed.time - odd.interval);
  const bool is_step =
      from_step < from_loss && from_loss > kMinStds * of_loss && from_step < kMaxStds * of_step;
  const bool is_loss =
      from_loss < from_step && from_step > kMinStds * of_step && from_loss < kMaxStds * of_loss;
  if (!is_step && !is_loss) return;
  odd.cause = is_step ? OddInterval::Cause::clock_step : OddInterval::Cause::lost_rows;
  odd.std = of_step;
}

/// How far the values change from a row to the next.
double change_after(const MeasuredStream& stream, std::size_t row) {
  return (stream.values[row + 1] - stream.values[row]).norm();
}

/// Rows with one value, and how far the values change after them.
struct ValueRun {
  std::size_t begin = 0, rows = 0;
  double change = 0.0;

  [[nodiscard]] double change_per_row() const { return change / static_cast<double>(rows); }
};

/// Without the last one, after which nothing changes.
std::vector<ValueRun> runs_of(const MeasuredStream& stream) {
  std::vector<ValueRun> runs;
  std::size_t begin = 0;
  for (std::size_t row = 0; row + 1 < stream.values.size(); ++row) {
    const double change = change_after(stream, row);
    if (change == 0.0) continue;
    runs.push_back({begin, row + 1 - begin, change});
    begin = row + 1;
  }
  return runs;
}

/// Median of the changes per row of the runs before and after one.
double usual_change(const std::vector<ValueRun>& runs, std::size_t at) {
  std::vector<double> changes;
  const std::size_t end = std::min(at + kAround + 1, runs.size());
  for (std::size_t k = at - std::min(at, kAround); k < end; ++k) {
    if (k != at) changes.push_back(runs[k].change_per_row());
  }
  return median(std::move(changes));
}

/// Whether the value changes at once as far as the motion went in all of the run's rows, rather
/// than in one row: nearer to it as a ratio.
bool has_caught_up(const ValueRun& run, double usual) {
  const auto rows = static_cast<double>(run.rows);
  return run.change > std::sqrt(rows) * usual && run.change < kMaxCatchUp * rows * usual;
}

/// Whether most rows repeat the one before: by a coarse resolution, or at rest.
bool is_mostly_resting(const MeasuredStream& stream) {
  std::size_t resting = 0;
  for (std::size_t row = 0; row + 1 < stream.values.size(); ++row) {
    resting += change_after(stream, row) == 0.0 ? 1 : 0;
  }
  return static_cast<double>(resting) > kMaxResting * static_cast<double>(stream.values.size());
}

/// Whether the values have a noise that is finer than its size, as a sensor's has, and most of
/// their changes are: then no row repeats another by chance, at rest neither.
bool is_continuous_noise(const MeasuredStream& stream) {
  std::vector<double> changes, bends;
  for (std::size_t row = 1; row + 1 < stream.values.size(); ++row) {
    const Values before = stream.values[row] - stream.values[row - 1];
    const Values after = stream.values[row + 1] - stream.values[row];
    if (before.isZero(0.0) || after.isZero(0.0)) continue;
    changes.push_back(after.norm());
    bends.push_back((after - before).norm());
  }
  if (changes.size() < kMinStreamRows) return false;
  const double ratio = median(bends) / median(changes);
  const std::size_t all = changes.size();
  std::sort(changes.begin(), changes.end());
  const auto distinct = std::unique(changes.begin(), changes.end()) - changes.begin();
  return ratio > kMinNoiseBend &&
         median(changes) > kMinMotion * quantile_of(changes, kLargeShare) &&
         static_cast<double>(distinct) > kMinDistinct * static_cast<double>(all);
}

}  // namespace

MeasuredStream measured_poses(std::string name, const std::vector<TimedPose>& poses, Stamp start) {
  MeasuredStream stream{.name = std::move(name)};
  for (const TimedPose& timed : poses) {
    stream.t.push_back(to_seconds(timed.stamp - start));
    Values values;
    values << timed.pose * Eigen::Vector3d(kLever, 0.0, 0.0),
        timed.pose * Eigen::Vector3d(0.0, kLever, 0.0);
    stream.values.push_back(values);
  }
  return stream;
}

std::vector<OddInterval> find_odd_intervals(const MeasuredStream& stream) {
  std::vector<OddInterval> found;
  if (stream.t.size() < kMinStreamRows) return found;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stream.t.size(); ++i) {
    intervals.push_back(stream.t[i] - stream.t[i - 1]);
  }
  const double usual = median(intervals);
  std::vector<double> distances;
  for (const double interval : intervals) distances.push_back(std::abs(interval - usual));
  const double others =
      1.0 - static_cast<double>(kMaxOdd + 1) / static_cast<double>(distances.size());
  const double scatter = quantile_of(distances, others);
  const double limit = std::max({kMinOdd, kMinOddShare * usual, kMinOddScatters * scatter});
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (distances[i] <= limit) continue;
    found.push_back({.t = stream.t[i], .interval = intervals[i], .usual = usual});
    judge(stream, i, found.back());
  }
  return found;
}

HeldStretches find_held_stretches(const MeasuredStream& stream) {
  HeldStretches found;
  if (stream.values.size() < kMinStreamRows || is_mostly_resting(stream)) return found;
  const bool is_noisy = is_continuous_noise(stream);
  const std::vector<ValueRun> runs = runs_of(stream);
  std::vector<double> changes;
  for (const ValueRun& run : runs) changes.push_back(run.change);
  const double min_step = kMinSteps * quantile_of(changes, kSmallShare);
  const double min_motion = kMinMotion * quantile_of(changes, kLargeShare);
  for (std::size_t k = 1; k < runs.size(); ++k) {
    const ValueRun& run = runs[k];
    if (run.rows == 1 || run.change < min_motion) continue;
    const bool catches_up = run.change > min_step && has_caught_up(run, usual_change(runs, k));
    const bool has_no_noise = is_noisy && run.rows <= kMaxHeld;
    if (!catches_up && !has_no_noise) continue;
    ++found.stretches;
    const std::size_t last = run.begin + run.rows - 1;
    for (std::size_t row = run.begin + 1; row <= last; ++row) found.repeated.push_back(row);
    const double length = stream.t[last] - stream.t[run.begin];
    if (length > found.longest) found.longest = length, found.t_longest = stream.t[run.begin];
  }
  return found.repeated.size() < kMinHeld ? HeldStretches() : found;
}

}  // namespace pcavr
