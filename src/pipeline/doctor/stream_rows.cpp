// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/stamp_units.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include "diagnosis_rows.hpp"

namespace pcavr {
namespace {

constexpr double kMinStreamGap = 0.05;       // [s] as `identify` has it
constexpr double kMinStreamIntervals = 4.0;  // [usual intervals] as streams have jitter
constexpr std::size_t kMinDriftRows = 100;   // fewer show no drift of the rate
constexpr double kMaxRateDrift = 0.05;       // from the first half to the second
constexpr double kMaxTravel = 20.0;          // [m] of a tool: no arm reaches as far
/// [rad] Arms turn a joint by one turn and a half at most; degrees are larger.
constexpr double kMaxJointAngle = 3.0 * std::numbers::pi + 0.1;

/// A stream's stamps, and what lacks without it.
struct StreamTimes {
  std::string name;
  std::vector<double> t;  ///< [s] from the recording's start
  std::string purpose;
};

template <typename Samples, typename StampOf>
StreamTimes times_of(std::string name, std::string purpose, const Samples& samples, Stamp start,
                     const StampOf& stamp_of) {
  StreamTimes times{.name = std::move(name), .t = {}, .purpose = std::move(purpose)};
  times.t.reserve(samples.size());
  for (const auto& sample : samples) times.t.push_back(to_seconds(stamp_of(sample) - start));
  return times;
}

std::vector<StreamTimes> streams_of(const Recording& recording) {
  const Stamp start = start_of(recording);
  const auto stamp = [](const auto& sample) { return sample.stamp; };
  std::vector<StreamTimes> streams;
  streams.push_back(times_of(recording.has_depth ? "rgb.txt, depth.txt" : "rgb.txt",
                             "build needs images", recording.frames, start,
                             [](const FrameFiles& frame) { return frame.depth_stamp; }));
  streams.push_back(times_of("groundtruth.txt", "the camera's poses are to follow from base tags",
                             recording.groundtruth.poses(), start, stamp));
  streams.push_back(times_of("tool.csv", "identify and replay need the tip's poses",
                             recording.tool.poses(), start, stamp));
  streams.push_back(
      times_of("wrench.csv", "identify needs the force", recording.wrench, start, stamp));
  streams.push_back(times_of("joints.csv", "an arm's friction and links are not known",
                             recording.joints, start, stamp));
  return streams;
}

/// Intervals between the samples of a stream [s].
struct Intervals {
  explicit Intervals(const std::vector<double>& t) {
    for (std::size_t i = 1; i < t.size(); ++i) all.push_back(t[i] - t[i - 1]);
  }
  /// Longer ones are gaps.
  [[nodiscard]] double min_gap() const {
    return std::max(kMinStreamGap, kMinStreamIntervals * median(all));
  }
  /// Change of the usual interval from the first half to the second [1].
  [[nodiscard]] std::optional<double> drift() const {
    if (all.size() < kMinDriftRows) return std::nullopt;
    const auto middle = all.begin() + std::ssize(all) / 2;
    return median({all.begin(), middle}) / median({middle, all.end()}) - 1.0;
  }

  std::vector<double> all;
};

void add_rate(const StreamTimes& stream, std::vector<DiagnosisRow>& rows) {
  const std::vector<double>& t = stream.t;
  if (t.empty()) return rows.push_back(unchecked(stream.name, "absent: " + stream.purpose));
  if (t.size() == 1) return rows.push_back(unchecked(stream.name, "one row shows no rate"));
  const Intervals intervals(t);
  const double span = t.back() - t.front();
  const auto longest = std::max_element(intervals.all.begin(), intervals.all.end());
  const double min_gap = intervals.min_gap();
  const auto gaps = std::count_if(intervals.all.begin(), intervals.all.end(),
                                  [min_gap](double interval) { return interval > min_gap; });
  std::string figure = fmt::format("{} rows over {:.3f} s, {:.1f} Hz", t.size(), span,
                                   static_cast<double>(t.size() - 1) / span);
  if (gaps > 0) {
    const double at = t[static_cast<std::size_t>(longest - intervals.all.begin())];
    rows.push_back(
        disagreement(stream.name,
                     fmt::format("{}; {} gap{}, the longest of {:.3f} s at t = {:.3f} s", figure,
                                 gaps, gaps == 1 ? "" : "s", *longest, at),
                     "samples were lost, or the logger paused: nothing is known of that time"));
    return;
  }
  figure += fmt::format("; no gaps, longest interval {:.1f} ms", 1e3 * *longest);
  const std::optional<double> drift = intervals.drift();
  if (drift && std::abs(*drift) > kMaxRateDrift) {
    rows.push_back(disagreement(
        stream.name,
        fmt::format("{}; the rate changes by {:+.1f} % from the first half to the second", figure,
                    100.0 * *drift),
        "the logger's clock or load changed: use the sensor's own stamps"));
    return;
  }
  if (drift) figure += fmt::format(", rate constant to {:.1f} %", 100.0 * std::abs(*drift));
  rows.push_back(agreement(stream.name, std::move(figure)));
}

/// A note about a stream, "FILE: TEXT".
DiagnosisRow note_row(const std::string& note, std::string cause) {
  const std::size_t colon = note.find(": ");
  if (colon == note.npos) return disagreement("recording", note, std::move(cause));
  return disagreement(note.substr(0, colon), note.substr(colon + 2), std::move(cause));
}

constexpr char kHeldCause[] =
    "a source is republished faster than it changes: log it at its own rate";

/// The objects' tracked poses that come with the recording.
void add_tracks(const Recording& recording, std::vector<DiagnosisRow>& rows) {
  const auto folder = tracked_folder_of(recording, std::nullopt);
  for (const ObjectEntry& object : recording.manifest.objects) {
    if (!object.is_movable) continue;
    const std::string name = "tracking of " + object.name;
    if (!folder) {
      rows.push_back(unchecked(name, "absent: its motion is to follow from tags or from pushes"));
      continue;
    }
    const auto tracked =
        read_tracked_poses(*folder, object.name, {.zero = start_of(recording), .skip_bad = false});
    if (!tracked) {
      rows.push_back(row_of(tracked.error()));
      continue;
    }
    StreamTimes times{.name = name, .t = {}, .purpose = "its motion is to follow from the pushes"};
    for (const TrackedPose& pose : tracked->poses) times.t.push_back(pose.t);
    add_rate(times, rows);
    if (tracked->note) rows.push_back(note_row(*tracked->note, kHeldCause));
    for (const SkippedRows& skipped : tracked->left_out) {
      rows.push_back(disagreement(name, skipped.reason,
                                  "the tracker mistook the body or its markers; these poses are "
                                  "not used"));
    }
  }
}

/// "the streams overlap", and that their stamps are in seconds.
void add_clocks(const Recording& recording, std::vector<DiagnosisRow>& rows) {
  const std::vector<ClockConflict> conflicts = find_clock_conflicts(recording);
  for (const ClockConflict& conflict : conflicts) {
    rows.push_back(disagreement("clocks of " + conflict.first + " and " + conflict.second,
                                conflict.message, "two clocks: put both streams on one"));
  }
  const std::vector<StreamPace> paces = paces_of(recording);
  if (conflicts.empty() && paces.size() > 1) {
    rows.push_back(
        agreement("clocks", fmt::format("the times of {} streams overlap", paces.size())));
  }
  const std::vector<std::string> doubts = doubtful_stamp_units(paces);
  for (const std::string& doubt : doubts) {
    rows.push_back(note_row(doubt, "another unit of the stamps"));
  }
  if (doubts.empty() && !paces.empty()) {
    rows.push_back(agreement("unit of the stamps", "rates and speeds fit seconds"));
  }
}

/// The tip's path in metres.
void add_path(const Recording& recording, std::vector<DiagnosisRow>& rows) {
  if (recording.tool.empty()) return;
  Eigen::AlignedBox3d box;
  for (const TimedPose& timed : recording.tool.poses()) box.extend(timed.pose.translation());
  const StreamPace pace = pace_of("tool.csv", StreamPace::Kind::tool, recording.tool);
  std::string figure = fmt::format("the tip moves within {:.3f} x {:.3f} x {:.3f} m",
                                   box.sizes().x(), box.sizes().y(), box.sizes().z());
  if (pace.speed) figure += fmt::format(", at {:.3f} m/s at most", *pace.speed);
  rows.push_back(box.diagonal().norm() > kMaxTravel
                     ? disagreement("unit of tool.csv", std::move(figure),
                                    "positions in millimetres: divide them by 1000")
                     : agreement("unit of tool.csv", std::move(figure)));
}

/// The joints' positions in radians.
void add_joint_range(const Recording& recording, std::vector<DiagnosisRow>& rows) {
  if (recording.joints.empty()) return;
  double farthest = 0.0;
  for (const JointSample& sample : recording.joints) {
    for (const double q : sample.position) farthest = std::max(farthest, std::abs(q));
  }
  const std::string figure = fmt::format("positions within +- {:.3g}", farthest);
  rows.push_back(farthest > kMaxJointAngle ? disagreement("unit of joints.csv", figure,
                                                          "degrees: multiply them by pi / 180")
                                           : agreement("unit of joints.csv", figure + " rad"));
}

}  // namespace

std::vector<DiagnosisRow> stream_rows(const Recording& recording) {
  std::vector<DiagnosisRow> rows;
  for (const StreamTimes& stream : streams_of(recording)) add_rate(stream, rows);
  add_tracks(recording, rows);
  for (const std::string& note : recording.notes) rows.push_back(note_row(note, kHeldCause));
  for (const std::string& warning : recording.warnings) {
    rows.push_back(note_row(warning, "check the file"));
  }
  add_clocks(recording, rows);
  add_path(recording, rows);
  add_joint_range(recording, rows);
  return rows;
}

}  // namespace pcavr
