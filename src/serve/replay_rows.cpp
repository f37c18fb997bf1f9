// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "replay_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "pcavr/base/core/raw_bytes.hpp"
#include "pcavr/base/geometry/matched_poses.hpp"

namespace pcavr {
namespace {

/// Screens refresh at most 120 times a second.
constexpr double kPoseInterval = 0.005;  ///< [s]
constexpr double kSamePosition = 1e-5;   ///< [m] less than a pixel at any distance
constexpr double kSameRotation = 1e-5;   ///< [rad]
/// A plot of a minute is at most 3 000 pixels wide.
constexpr double kForceInterval = 0.02;  ///< [s]
/// The wrench is sampled at 100 Hz or more: a longer gap is the end of a contact.
constexpr double kMaxForceGap = 0.05;  ///< [s]
constexpr double kRounding = 1e-9;     ///< [s] of times that are multiples of a step

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

bool is_same(const Pose& a, const Pose& b) {
  return translation_distance(a, b) <= kSamePosition && rotation_distance(a, b) <= kSameRotation;
}

/// The rows just before and after each of the times.
std::set<std::size_t> rows_around(const std::vector<ShownPose>& shown,
                                  const std::vector<double>& times) {
  std::set<std::size_t> rows;
  for (const double t : times) {
    const auto after = std::partition_point(shown.begin(), shown.end(),
                                            [&](const ShownPose& pose) { return pose.t < t; });
    const auto i = static_cast<std::size_t>(after - shown.begin());
    if (i < shown.size()) rows.insert(i);
    if (i > 0) rows.insert(i - 1);
  }
  return rows;
}

/// Rows 5 ms apart and those in `required`, including the first and the last.
std::vector<std::size_t> spaced_rows(const std::vector<ShownPose>& shown,
                                     const std::set<std::size_t>& required) {
  std::vector<std::size_t> rows;
  double next = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const bool is_due = shown[i].t >= next - kRounding;
    if (!is_due && !required.contains(i) && i + 1 < shown.size()) continue;
    rows.push_back(i);
    if (is_due) next = shown[i].t + kPoseInterval;
  }
  return rows;
}

std::vector<std::size_t> kept_rows(const std::vector<ShownPose>& shown,
                                   const std::vector<double>& keep) {
  const std::set<std::size_t> required = rows_around(shown, keep);
  const std::vector<std::size_t> spaced = spaced_rows(shown, required);
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < spaced.size(); ++k) {
    const Pose& pose = shown[spaced[k]].T_base_object;
    const bool is_end = k == 0 || k + 1 == spaced.size();
    // The last row at rest is kept, too: interpolation would start the next motion too early.
    if (is_end || required.contains(spaced[k]) ||
        !is_same(pose, shown[kept.back()].T_base_object) ||
        !is_same(shown[spaced[k + 1]].T_base_object, shown[kept.back()].T_base_object)) {
      kept.push_back(spaced[k]);
    }
  }
  return kept;
}

/// The first of the rows [first, last), and the extremes of both curves in them (min-max
/// decimation).
std::set<std::size_t> envelope(const std::vector<ForceRow>& forces, std::size_t first,
                               std::size_t last) {
  std::set<std::size_t> rows{first};
  for (double ForceRow::*curve : {&ForceRow::measured, &ForceRow::predicted}) {
    std::size_t lowest = first;
    std::size_t highest = first;
    for (std::size_t i = first; i < last; ++i) {
      if (forces[i].*curve < forces[lowest].*curve) lowest = i;
      if (forces[i].*curve > forces[highest].*curve) highest = i;
    }
    rows.insert(lowest);
    rows.insert(highest);
  }
  return rows;
}

Trajectory trajectory_of(const std::vector<TrackedPose>& tracked) {
  Trajectory trajectory;
  for (const TrackedPose& pose : tracked) {
    trajectory.append(Stamp::from_seconds(pose.t), pose.T_base_object);
  }
  return trajectory;
}

}  // namespace

void ReplayTables::append(double number) { append_bytes(bytes_, static_cast<float>(number)); }

void ReplayTables::append_pose(double t, const Pose& pose, ReplayTable& table) {
  append_time(t);
  for (const double coordinate : pose.translation()) append(coordinate);
  for (const double coefficient : pose.rotation().coeffs()) append(coefficient);  // x y z w
  ++table.rows;
}

ReplayTable ReplayTables::add_predicted(const std::vector<ShownPose>& shown,
                                        const std::vector<double>& keep) {
  ReplayTable table = begin();
  for (const std::size_t i : kept_rows(shown, keep)) {
    append_pose(shown[i].t, shown[i].T_base_object, table);
  }
  return table;
}

ReplayTable ReplayTables::add_tracked(const std::vector<TrackedPose>& tracked) {
  ReplayTable table = begin();
  for (const TrackedPose& pose : tracked) append_pose(pose.t, pose.T_base_object, table);
  return table;
}

ReplayTable ReplayTables::add_force(const std::vector<ForceRow>& forces) {
  ReplayTable table = begin();
  const auto add = [&](double t, double measured, double predicted) {
    append_time(t);
    append(measured);
    append(predicted);
    ++table.rows;
  };
  std::size_t first = 0;
  while (first < forces.size()) {
    std::size_t last = first + 1;
    while (last < forces.size() && forces[last].t < forces[first].t + kForceInterval - kRounding &&
           forces[last].t - forces[last - 1].t <= kMaxForceGap) {
      ++last;
    }
    std::set<std::size_t> rows = envelope(forces, first, last);
    const bool is_end = last == forces.size() || forces[last].t - forces[last - 1].t > kMaxForceGap;
    if (is_end) rows.insert(last - 1);
    for (const std::size_t i : rows) add(forces[i].t, forces[i].measured, forces[i].predicted);
    if (is_end && last < forces.size()) add(forces[last - 1].t, kNoValue, kNoValue);
    first = last;
  }
  return table;
}

ReplayTable ReplayTables::add_errors(const std::vector<Error>& errors) {
  const ReplayTable table{bytes_.size(), errors.size()};
  for (const Error& error : errors) {
    append_time(error.t);
    append(error.position);
    append(error.rotation);
  }
  return table;
}

ReplayTable ReplayTables::add_tool(const Trajectory& tool,
                                   const std::vector<WrenchSample>& wrench) {
  ReplayTable table = begin();
  double next = -std::numeric_limits<double>::infinity();
  std::size_t sample = 0;  // the first one after the tool's stamp
  for (const TimedPose& pose : tool.poses()) {
    const double t = pose.stamp.seconds();
    if (t < next - kRounding) continue;
    next = t + kPoseInterval;
    while (sample < wrench.size() && wrench[sample].stamp <= pose.stamp) ++sample;
    append_time(t);
    for (const double coordinate : pose.pose.translation()) append(coordinate);
    for (int axis = 0; axis < 3; ++axis) {
      append(sample == 0 ? double{kNoValue} : wrench[sample - 1].force[axis]);
    }
    ++table.rows;
  }
  return table;
}

ReplayTable ReplayTables::add_arm(const JointLog& log) {
  ReplayTable table = begin();
  double next = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < log.stamps.size(); ++i) {
    const double t = log.stamps[i].seconds();
    const bool is_due = t >= next - kRounding;
    if (!is_due && i + 1 < log.stamps.size()) continue;
    if (is_due) next = t + kPoseInterval;
    append_time(t);
    for (const double q : log.position.row(static_cast<Eigen::Index>(i))) append(q);
    ++table.rows;
  }
  return table;
}

std::vector<ReplayTables::Error> replay_errors(const std::vector<ShownPose>& shown,
                                               const std::vector<TrackedPose>& tracked) {
  Trajectory predicted;
  for (const ShownPose& pose : shown) {
    predicted.append(Stamp::from_seconds(pose.t), pose.T_base_object);
  }
  constexpr Duration kMaxGap = std::chrono::milliseconds(200);
  std::vector<ReplayTables::Error> errors;
  for (const MatchedPose& pair : match(predicted, trajectory_of(tracked), kMaxGap)) {
    errors.push_back({pair.stamp.seconds(), translation_distance(pair.reference, pair.estimate),
                      rotation_distance(pair.reference, pair.estimate)});
  }
  return errors;
}

std::vector<double> times_of_largest(const std::vector<ReplayTables::Error>& errors) {
  std::vector<double> times;
  for (double ReplayTables::Error::*kind :
       {&ReplayTables::Error::position, &ReplayTables::Error::rotation}) {
    const auto largest =
        std::max_element(errors.begin(), errors.end(),
                         [&](const auto& a, const auto& b) { return a.*kind < b.*kind; });
    if (largest != errors.end()) times.push_back(largest->t);
  }
  return times;
}

}  // namespace pcavr
