// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/pose_stream.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/recordings/recording/held_samples.hpp"
#include "pcavr/recordings/recording/stream_faults.hpp"

namespace pcavr {
namespace {

constexpr double kPoseLever = 0.1;       ///< [m] by which rotations count against positions
constexpr double kMinWildStep = 5e-3;    ///< [m] smaller ones do no harm
constexpr double kWildFactor = 12.0;     ///< of the typical distance from the neighbours
constexpr std::size_t kWildWindow = 15;  ///< poses before and after that are typical
constexpr int kWildPasses = 3;           ///< of poses that are wild side by side

double distance_between(const Pose& a, const Pose& b) {
  return translation_distance(a, b) + kPoseLever * rotation_distance(a, b);
}

/// [m] of each pose from the one interpolated between its neighbours; 0 at the ends.
std::vector<double> distances_from_neighbours(const std::vector<TimedPose>& poses) {
  std::vector<double> distances(poses.size(), 0.0);
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    const double span = to_seconds(poses[i + 1].stamp - poses[i - 1].stamp);
    const double part = to_seconds(poses[i].stamp - poses[i - 1].stamp) / span;
    distances[i] =
        distance_between(poses[i].pose, interpolate(poses[i - 1].pose, poses[i + 1].pose, part));
  }
  return distances;
}

/// Removes poses that are far from both neighbours, where these are near each other.
std::size_t remove_wild(std::vector<TimedPose>& poses) {
  const std::vector<double> distances = distances_from_neighbours(poses);
  std::vector<TimedPose> kept;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::size_t begin = i - std::min(i, kWildWindow);
    const std::size_t end = std::min(i + kWildWindow + 1, poses.size());
    const auto at = [&](std::size_t k) {
      return distances.begin() + static_cast<std::ptrdiff_t>(k);
    };
    const double typical = median(std::vector<double>(at(begin), at(end)));
    const double limit = std::max(kMinWildStep, kWildFactor * typical);
    const bool is_peak = i > 0 && i + 1 < poses.size() && distances[i] >= distances[i - 1] &&
                         distances[i] >= distances[i + 1];
    if (is_peak && distances[i] > limit) continue;
    kept.push_back(poses[i]);
  }
  const std::size_t removed = poses.size() - kept.size();
  poses = std::move(kept);
  return removed;
}

std::string rows_text(std::size_t count) {
  return fmt::format("{} {}", count, count == 1 ? "row is" : "rows are");
}

/// Sorts by stamp, and keeps the first of each.
void sort_rows(std::vector<TimedPose>& rows, PoseStream& stream) {
  std::optional<Stamp> last;
  for (const TimedPose& row : rows) {
    if (last && row.stamp < *last) ++stream.out_of_order;
    last = row.stamp;
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.stamp < b.stamp; });
  const auto end =
      std::unique(rows.begin(), rows.end(),
                  [](const TimedPose& a, const TimedPose& b) { return a.stamp == b.stamp; });
  stream.repeated = static_cast<std::size_t>(rows.end() - end);
  rows.erase(end, rows.end());
  if (stream.out_of_order > 0) {
    stream.notes.push_back(stream.name + ": " + rows_text(stream.out_of_order) +
                           " out of order: sorted by their stamps");
  }
  if (stream.repeated > 0) {
    stream.notes.push_back(stream.name + ": " + rows_text(stream.repeated) +
                           " left out: another one has the same stamp");
  }
}

/// Leaves out the rows of single stretches in which values repeat.
void leave_out_stretches(std::vector<TimedPose>& rows, PoseStream& stream) {
  if (rows.empty()) return;
  const HeldStretches held =
      find_held_stretches(measured_poses(stream.name, rows, rows.front().stamp));
  if (held.stretches == 0) return;
  std::vector<TimedPose> kept;
  auto repeated = held.repeated.begin();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const bool is_repeated = repeated != held.repeated.end() && *repeated == row;
    if (is_repeated) ++repeated;
    if (!is_repeated) kept.push_back(rows[row]);
  }
  rows = std::move(kept);
  stream.repeated += held.repeated.size();
  stream.notes.push_back(
      fmt::format("{}: {} rows repeat the one before in {} stretches, the longest of {:.1f} ms: "
                  "held samples, left out",
                  stream.name, held.repeated.size(), held.stretches, 1e3 * held.longest));
}

}  // namespace

double PoseStream::interval() const {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    intervals.push_back(to_seconds(poses.poses()[i].stamp - poses.poses()[i - 1].stamp));
  }
  return median(std::move(intervals));
}

PoseStream clean_stream(std::string name, std::vector<TimedPose> rows) {
  PoseStream stream{.name = std::move(name), .poses = {}};
  sort_rows(rows, stream);
  Trajectory sorted(std::move(rows));
  const std::size_t before = sorted.size();
  if (const auto note = leave_out_held(stream.name, sorted)) {
    stream.notes.push_back(*note);
    stream.repeated += before - sorted.size();
  }
  std::vector<TimedPose> poses = sorted.poses();
  leave_out_stretches(poses, stream);
  for (int pass = 0; pass < kWildPasses; ++pass) {
    const std::size_t removed = remove_wild(poses);
    stream.wild += removed;
    if (removed == 0) break;
  }
  if (stream.wild > 0) {
    stream.notes.push_back(stream.name + ": " + rows_text(stream.wild) +
                           " left out: the pose jumps there and back");
  }
  stream.poses = Trajectory(std::move(poses));
  return stream;
}

}  // namespace pcavr
