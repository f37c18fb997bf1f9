// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/stamp_units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

using Kind = StreamPace::Kind;

struct StampUnit {
  const char* name;
  double per_second;
};
constexpr auto kUnits = std::to_array<StampUnit>({{"milliseconds", 1e3},
                                                  {"hundredths of a second", 1e2},
                                                  {"microseconds", 1e6},
                                                  {"nanoseconds", 1e9}});

constexpr std::size_t kMinRows = 20;     ///< fewer show no pace
constexpr double kSlowSensor = 0.12;     ///< [s] tools and forces are sampled at 10 Hz or more
constexpr double kSlowCamera = 1.5;      ///< [s] cameras that watch a push at 1 Hz or more
constexpr double kSlowTool = 0.005;      ///< [m/s] robots come to a contact faster
constexpr double kMinTravel = 0.02;      ///< [m] less may be a tool that rests
constexpr double kShortInterval = 4e-4;  ///< [s] of the fastest controllers, and some
constexpr double kLongInterval = 0.2;    ///< [s] of a slow sensor
constexpr double kFastTool = 3.0;        ///< [m/s]
constexpr double kSameSpan = 0.05;       ///< of the span: streams begin and end together
constexpr std::size_t kSpeedRows = 10;   ///< over which a speed is taken: noise is small beside it

template <typename Stamps>
void set_times(std::size_t rows, const Stamps& stamp, StreamPace& pace) {
  pace.rows = rows;
  if (rows < 2) return;
  std::vector<double> intervals;
  intervals.reserve(rows - 1);
  for (std::size_t i = 1; i < rows; ++i) intervals.push_back(to_seconds(stamp(i) - stamp(i - 1)));
  pace.interval = median(std::move(intervals));
  pace.span = to_seconds(stamp(rows - 1) - stamp(0));
}

/// Speed [m/s] that 99 in 100 stretches do not exceed; nullopt where the poses hardly leave their
/// place.
std::optional<double> speed_of(const std::vector<TimedPose>& poses) {
  Eigen::AlignedBox3d box;
  for (const TimedPose& timed : poses) box.extend(timed.pose.translation());
  if (poses.size() <= kSpeedRows || box.diagonal().norm() < kMinTravel) return std::nullopt;
  std::vector<double> speeds;
  for (std::size_t i = kSpeedRows; i < poses.size(); ++i) {
    const TimedPose& before = poses[i - kSpeedRows];
    speeds.push_back((poses[i].pose.translation() - before.pose.translation()).norm() /
                     to_seconds(poses[i].stamp - before.stamp));
  }
  const auto high = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * 99 / 100);
  std::nth_element(speeds.begin(), high, speeds.end());
  return *high;
}

double slow_interval(Kind kind) {
  return kind == Kind::frames || kind == Kind::tracking ? kSlowCamera : kSlowSensor;
}

bool is_slow(const StreamPace& pace) { return pace.interval > slow_interval(pace.kind); }

bool is_interval_of_sensor(double interval) {
  return interval >= kShortInterval && interval <= kLongInterval;
}

std::string rate_text(double interval) {
  return interval > 1.0 ? fmt::format("one row in {:.3g} s", interval)
                        : fmt::format("{:.3g} rows a second", 1.0 / interval);
}

/// A warning about a stream that is too slow for its kind and lasts longer than one that is not, by
/// the factor of a unit of time.
std::optional<std::string> longer_than(const StreamPace& slow, const StreamPace& other) {
  if (!is_slow(slow) || is_slow(other) || !(other.span > 0.0)) return std::nullopt;
  for (const StampUnit& unit : kUnits) {
    const double ratio = slow.span / other.span / unit.per_second;
    if (std::abs(ratio - 1.0) > kSameSpan) continue;
    if (!is_interval_of_sensor(slow.interval / unit.per_second)) continue;
    return fmt::format(
        "{}: the stamps are probably in {}: {} over {:.6g} s, where {} lasts {:.4g} s; write them "
        "in seconds",
        slow.name, unit.name, rate_text(slow.interval), slow.span, other.name, other.span);
  }
  return std::nullopt;
}

/// A warning about a tool that is too slow for any robot, where all streams recorded with it are as
/// slow.
std::optional<std::string> all_too_slow(const std::vector<StreamPace>& paces) {
  const auto tool = std::find_if(paces.begin(), paces.end(), [](const StreamPace& pace) {
    return pace.kind == Kind::tool && pace.speed && *pace.speed < kSlowTool;
  });
  if (tool == paces.end() || !std::all_of(paces.begin(), paces.end(), is_slow)) return std::nullopt;
  for (const StampUnit& unit : kUnits) {
    if (*tool->speed * unit.per_second > kFastTool) continue;
    const bool fits = std::all_of(paces.begin(), paces.end(), [&](const StreamPace& pace) {
      return is_interval_of_sensor(pace.interval / unit.per_second);
    });
    if (!fits) continue;
    std::string others;
    for (const StreamPace& pace : paces) {
      if (&pace != &*tool)
        others += fmt::format(", {} has {}", pace.name, rate_text(pace.interval));
    }
    return fmt::format(
        "{}: the stamps may be in {}: {} of a tool that moves at {:.2g} mm/s at most{}; write them "
        "in seconds: all speeds and viscous friction depend on it",
        tool->name, unit.name, rate_text(tool->interval), 1e3 * *tool->speed, others);
  }
  return std::nullopt;
}

}  // namespace

StreamPace pace_of(std::string name, Kind kind, const Trajectory& poses) {
  StreamPace pace{.name = std::move(name), .kind = kind};
  set_times(
      poses.size(), [&](std::size_t i) { return poses.poses()[i].stamp; }, pace);
  pace.speed = speed_of(poses.poses());
  return pace;
}

std::vector<StreamPace> paces_of(const Recording& recording) {
  std::vector<StreamPace> paces;
  const auto add = [&](const char* name, Kind kind, std::size_t rows, const auto& stamp) {
    set_times(rows, stamp, paces.emplace_back(StreamPace{.name = name, .kind = kind}));
  };
  paces.push_back(pace_of("tool.csv", Kind::tool, recording.tool));
  add("wrench.csv", Kind::force, recording.wrench.size(),
      [&](std::size_t i) { return recording.wrench[i].stamp; });
  add("joints.csv", Kind::joints, recording.joints.size(),
      [&](std::size_t i) { return recording.joints[i].stamp; });
  add(recording.has_depth ? "depth.txt" : "rgb.txt", Kind::frames, recording.frames.size(),
      [&](std::size_t i) { return recording.frames[i].depth_stamp; });
  std::erase_if(paces, [](const StreamPace& pace) { return pace.rows < kMinRows; });
  return paces;
}

std::optional<std::string> unit_of_interval(double interval) {
  for (const StampUnit& unit : kUnits) {
    if (is_interval_of_sensor(interval / unit.per_second)) return unit.name;
  }
  return std::nullopt;
}

std::vector<std::string> doubtful_stamp_units(const std::vector<StreamPace>& paces) {
  std::vector<std::string> warnings;
  for (const StreamPace& slow : paces) {
    for (const StreamPace& other : paces) {
      std::optional<std::string> warning = longer_than(slow, other);
      if (!warning) continue;
      warnings.push_back(*std::move(warning));
      break;
    }
  }
  if (!warnings.empty()) return warnings;
  if (std::optional<std::string> warning = all_too_slow(paces)) {
    warnings.push_back(*std::move(warning));
  }
  return warnings;
}

}  // namespace pcavr
