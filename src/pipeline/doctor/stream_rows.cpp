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
#include "pcavr/recordings/recording/stream_faults.hpp"

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

/// A stream, and what lacks without it.
struct NamedStream {
  MeasuredStream measured;  ///< times from the recording's start
  std::string purpose;
};

NamedStream poses_of(std::string name, std::string purpose, const Trajectory& poses, Stamp start) {
  return {measured_poses(std::move(name), poses.poses(), start), std::move(purpose)};
}

NamedStream images_of(const Recording& recording, Stamp start) {
  NamedStream images{{.name = recording.has_depth ? "rgb.txt, depth.txt" : "rgb.txt"},
                     "build needs images"};
  for (const FrameFiles& frame : recording.frames) {
    images.measured.t.push_back(to_seconds(frame.depth_stamp - start));
  }
  return images;
}

NamedStream force_of(const Recording& recording, Stamp start) {
  NamedStream force{{.name = "wrench.csv"}, "identify needs the force"};
  for (const WrenchSample& sample : recording.wrench) {
    force.measured.t.push_back(to_seconds(sample.stamp - start));
    MeasuredStream::Values values;
    values << sample.force, sample.torque;
    force.measured.values.push_back(values);
  }
  return force;
}

NamedStream joints_of(const Recording& recording, Stamp start) {
  NamedStream joints{{.name = "joints.csv"}, "an arm's friction and links are not known"};
  for (const JointSample& sample : recording.joints) {
    joints.measured.t.push_back(to_seconds(sample.stamp - start));
  }
  return joints;
}

std::vector<NamedStream> streams_of(const Recording& recording) {
  const Stamp start = start_of(recording);
  return {images_of(recording, start),
          poses_of("groundtruth.txt", "the camera's poses are to follow from base tags",
                   recording.groundtruth, start),
          poses_of("tool.csv", "identify and replay need the tip's poses", recording.tool, start),
          force_of(recording, start), joints_of(recording, start)};
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

constexpr char kLostSamples[] =
    "samples were lost, or the logger paused: nothing is known of that time";

/// What an interval that is unlike the others comes from.
std::string cause_of_interval(const OddInterval& odd) {
  const std::string set =
      fmt::format("its clock was set {} by {:.1f} ms", odd.step() > 0.0 ? "ahead" : "back",
                  1e3 * std::abs(odd.step()));
  switch (odd.cause) {
    case OddInterval::Cause::clock_step:
      return fmt::format(
          "{}, for the motion goes on as in {:.1f} +- {:.1f} ms: take that off the stamps after "
          "it, and stamp all streams by one clock",
          set, 1e3 * odd.usual, 1e3 * odd.std);
    case OddInterval::Cause::lost_rows:
      return kLostSamples;
    case OddInterval::Cause::unknown:
      break;
  }
  return odd.step() > 0.0
             ? "samples were lost, or " + set + ": nothing moves enough then to show which"
             : set + ", or a row was stamped late";
}

/// Intervals that are unlike the others, and are no gap of which there is a row.
void add_odd_intervals(const std::string& name, const std::vector<OddInterval>& intervals,
                       double min_gap, double longest, std::vector<DiagnosisRow>& rows) {
  for (const OddInterval& odd : intervals) {
    const bool is_in_gap_row =
        odd.interval > min_gap &&
        (odd.interval == longest || odd.cause != OddInterval::Cause::clock_step);
    if (is_in_gap_row) continue;
    rows.push_back(disagreement(
        name,
        fmt::format("an interval of {:.1f} ms at t = {:.3f} s, where the others are {:.1f} ms",
                    1e3 * odd.interval, odd.t, 1e3 * odd.usual),
        cause_of_interval(odd)));
  }
}

void add_held(const MeasuredStream& stream, std::vector<DiagnosisRow>& rows) {
  const HeldStretches held = find_held_stretches(stream);
  if (held.stretches == 0) return;
  rows.push_back(disagreement(
      stream.name,
      fmt::format("{} rows repeat the one before in {} stretches, the longest of {:.1f} ms at "
                  "t = {:.3f} s",
                  held.repeated.size(), held.stretches, 1e3 * held.longest, held.t_longest),
      "held samples: the source came late, and its last value was written again; leave these "
      "rows out"));
}

/// The cause of the longest gap.
std::string cause_of_gap(const std::vector<OddInterval>& intervals, double longest) {
  for (const OddInterval& odd : intervals) {
    if (odd.interval == longest) return cause_of_interval(odd);
  }
  return kLostSamples;
}

void add_rate(const NamedStream& named, std::vector<DiagnosisRow>& rows) {
  const MeasuredStream& stream = named.measured;
  const std::vector<double>& t = stream.t;
  if (t.empty()) return rows.push_back(unchecked(stream.name, "absent: " + named.purpose));
  if (t.size() == 1) return rows.push_back(unchecked(stream.name, "one row shows no rate"));
  const Intervals intervals(t);
  const double span = t.back() - t.front();
  const auto longest = std::max_element(intervals.all.begin(), intervals.all.end());
  const double min_gap = intervals.min_gap();
  const std::vector<OddInterval> odd = find_odd_intervals(stream);
  add_odd_intervals(stream.name, odd, min_gap, *longest, rows);
  add_held(stream, rows);
  const auto gaps = std::count_if(intervals.all.begin(), intervals.all.end(),
                                  [min_gap](double interval) { return interval > min_gap; });
  std::string figure = fmt::format("{} rows over {:.3f} s, {:.1f} Hz", t.size(), span,
                                   static_cast<double>(t.size() - 1) / span);
  if (gaps > 0) {
    const double at = t[static_cast<std::size_t>(longest - intervals.all.begin())];
    rows.push_back(disagreement(stream.name,
                                fmt::format("{}; {} gap{}, the longest of {:.3f} s at t = {:.3f} s",
                                            figure, gaps, gaps == 1 ? "" : "s", *longest, at),
                                cause_of_gap(odd, *longest)));
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
    std::vector<TimedPose> poses;
    for (const TrackedPose& pose : tracked->poses) {
      poses.push_back({Stamp::from_seconds(pose.t), pose.T_base_object});
    }
    add_rate({measured_poses(name, poses, Stamp()), "its motion is to follow from the pushes"},
             rows);
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
  for (const NamedStream& stream : streams_of(recording)) add_rate(stream, rows);
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
