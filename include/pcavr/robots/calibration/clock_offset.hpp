// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/robots/calibration/hand_eye.hpp"
#include "pcavr/robots/calibration/pose_stream.hpp"

namespace pcavr {

/// Clocks differ by 1e-4, and rates that are taken for others by 1e-3: a larger drift is none.
inline constexpr double kMaxClockDrift = 2e-3;

/// An instant from which on the offset of two clocks is another one: one of them was set.
struct ClockStep {
  double at = 0.0;    ///< [s] of b's stamps
  double size = 0.0;  ///< [s] by which the offset is larger from then on
  double std = 0.0;   ///< [s] of the size

  [[nodiscard]] double is_after(double t_b) const { return t_b >= at ? 1.0 : 0.0; }
};

/// The clock of stream b against that of stream a: t_a = t_b + offset + drift (t_b - middle), and
/// the step from its instant on.
struct ClockOffset {
  double offset = 0.0;  ///< [s] to add to b's stamps, before the step if there is one
  double std = 0.0;     ///< [s]
  std::optional<double> drift =
      {};  ///< [1] of b's clock against a's; nullopt: too short to show it
  double drift_std = 0.0;
  double middle = 0.0;                 ///< [s] of b's stamps
  std::optional<ClockStep> step = {};  ///< where the motion shows one
  double explained = 0.0;              ///< [1] part of a's motion that b's explains
  std::size_t samples = 0;
  double overlap = 0.0;  ///< [s] in which both move
  bool is_observable = false;
  std::string reason = {};                             ///< why it is not
  std::vector<double> residual_t = {}, residual = {};  ///< [s] of b's clock, [rad/s] or [m/s]

  /// [s] on a's clock.
  [[nodiscard]] double corrected(double t_b) const {
    const double stepped = step ? step->size * step->is_after(t_b) : 0.0;
    return t_b + offset + drift.value_or(0.0) * (t_b - middle) + stepped;
  }
};

struct ClockOffsetOptions {
  /// Any offset is searched with which the streams overlap by this part of the shorter one.
  double min_overlap = 0.3;
  bool is_drift_estimated = true;

  friend bool operator==(const ClockOffsetOptions&, const ClockOffsetOptions&) = default;
};

/// The offset of two streams of poses of one rigid body, whose frames differ by an unknown turn and
/// shift at either side: the body's angular velocity in its own axes is the same in both but for a
/// fixed turn. Where the body does not turn, its velocity is.
[[nodiscard]] ClockOffset estimate_clock_offset(const PoseStream& a, const PoseStream& b,
                                                const ClockOffsetOptions& options = {});

/// Up to `max_views` views of two streams of one motion, evenly spread: a's poses (of the flange in
/// base) at b's stamps (of the board in the camera), by a's clock.
[[nodiscard]] std::vector<HandEyeView> paired_views(const PoseStream& a, const PoseStream& b,
                                                    const ClockOffset& clock,
                                                    std::size_t max_views = 100);

}  // namespace pcavr
