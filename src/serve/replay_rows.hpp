// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// A table of numbers in /api/replay.bin.
struct ReplayTable {
  std::size_t at = 0;  ///< byte offset
  std::size_t rows = 0;
};

/// Writes the tables of docs/live-protocol.md in sequence. Times are relative to `start` [s] on the
/// recording's clock.
///
/// The prediction at 1 kHz is decimated: at most 200 rows a second, none between two with the same
/// pose (to 10 um and 10 urad), but always those around a change of phase and around the largest
/// error. Force keeps, of each 20 ms, the first row and the maximum and minimum of either curve.
class ReplayTables {
 public:
  explicit ReplayTables(double start) : start_(start) {}

  ReplayTable add_predicted(const std::vector<ShownPose>& shown, const std::vector<double>& keep);
  ReplayTable add_tracked(const std::vector<TrackedPose>& tracked);
  /// Adds the forces of one object, by ascending time; a row of NaN marks a gap in the contact.
  ReplayTable add_force(const std::vector<ForceRow>& forces);
  /// Distance of the predicted from the tracked pose, at the stamps of the latter.
  struct Error {
    double t = 0.0;         ///< [s] on the recording's clock
    double position = 0.0;  ///< [m]
    double rotation = 0.0;  ///< [rad]
  };
  ReplayTable add_errors(const std::vector<Error>& errors);
  /// The wrench is that of the last sample before; NaN if there is none.
  ReplayTable add_tool(const Trajectory& tool, const std::vector<WrenchSample>& wrench);

  /// Time and joint positions; at most 200 rows a second, and the last.
  ReplayTable add_arm(const JointLog& log);

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  ReplayTable begin() const { return {bytes_.size(), 0}; }
  void append(double number);
  void append_time(double t) { append(t - start_); }
  void append_pose(double t, const Pose& pose, ReplayTable& table);

  double start_;
  std::string bytes_;
};

/// The errors of the shown poses; empty if none were shown or none were tracked.
[[nodiscard]] std::vector<ReplayTables::Error> replay_errors(
    const std::vector<ShownPose>& shown, const std::vector<TrackedPose>& tracked);

/// The stamps of the largest error of either kind; none without errors.
[[nodiscard]] std::vector<double> times_of_largest(const std::vector<ReplayTables::Error>& errors);

}  // namespace pcavr
