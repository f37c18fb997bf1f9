// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// What one stream measures at its stamps.
struct MeasuredStream {
  using Values = Eigen::Matrix<double, 6, 1>;

  std::string name;
  std::vector<double> t = {};  ///< [s]
  /// [m] or [N], of which each row counts alike. Empty: only the stamps are known.
  std::vector<Values> values = {};
};

/// Two points of the frame that moves, so that its turn counts, too; times from `start` on.
[[nodiscard]] MeasuredStream measured_poses(std::string name, const std::vector<TimedPose>& poses,
                                            Stamp start);

/// An interval between two rows that is unlike the others of its stream.
struct OddInterval {
  enum class Cause {
    unknown,     ///< the stream rests, or its values are not known
    lost_rows,   ///< the motion has gone on for as long as the stamps say
    clock_step,  ///< the motion has gone on for one usual interval: the clock was set
  };
  double t = 0.0;         ///< [s] of the row before
  double interval = 0.0;  ///< [s]
  double usual = 0.0;     ///< [s]
  double std = 0.0;       ///< [s] of the step, by the motion; 0 where the cause is unknown
  Cause cause = Cause::unknown;

  /// [s] by which the clock was set ahead, if it was.
  [[nodiscard]] double step() const { return interval - usual; }
};

/// Nothing of a stream whose stamps jitter more than that.
[[nodiscard]] std::vector<OddInterval> find_odd_intervals(const MeasuredStream& stream);

/// Rows that repeat the one before while the stream moves, which then goes on where it would be
/// without them.
struct HeldStretches {
  std::size_t stretches = 0;
  std::vector<std::size_t> repeated = {};  ///< rows
  double longest = 0.0, t_longest = 0.0;   ///< [s]
};

[[nodiscard]] HeldStretches find_held_stretches(const MeasuredStream& stream);

}  // namespace pcavr
