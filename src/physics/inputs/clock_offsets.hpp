// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/inputs/input_options.hpp"

#include "physics/inputs/body_poses.hpp"

namespace pcavr {

/// Whether an offset exceeds `min_offset` [s] and its noise.
[[nodiscard]] bool is_significant(const TimeOffset& offset, double min_offset,
                                  const InputOptions& options);

/// Clock offset: the delay of the force's stamps against the tool's. During a press, and while a
/// push is released, the object is at rest, so that the tip's position is
///     q(t - offset) = surface + a (F / (1 + c q'))^(1/n),
/// by the contact law with damping. The offset with the smallest residual is found by a grid search
/// over +-0.25 s on smoothed signals, then refined by Gauss-Newton: on the measured signals where
/// there are presses, else on the smoothed ones. n is 1, 1.5 or 2, by the residual.
[[nodiscard]] TimeOffset force_offset(const Segmentation& found, std::span<const double> t_force,
                                      const PathView& tip);

/// The force's delay by one contact alone, as force_offset finds it.
struct PressDelay {
  double t = 0.0;      ///< [s] of its samples, by the force's stamps
  double delay = 0.0;  ///< [s]
  double std = 0.0;    ///< [s]
  double bias = 0.0;   ///< [s] that contacts with one body may share
};
/// Of all presses that show it; of the pushes, where there are too few presses.
[[nodiscard]] std::vector<PressDelay> press_delays(const Segmentation& found, const PathView& tip);

/// A delay that grows or shrinks with time, as that of a clock that is fast or slow.
struct ClockDrift {
  double at = 0.0;        ///< [s]
  double offset = 0.0;    ///< [s] the delay there
  double rate = 0.0;      ///< [s/s] it grows by
  double rate_std = 0.0;  ///< [s/s]

  [[nodiscard]] double delay(double t) const { return offset + rate * (t - at); }
};
/// The line through most of the delays; empty where a constant explains them as well.
[[nodiscard]] std::optional<ClockDrift> find_drift(std::span<const PressDelay> delays);

/// The same offset by cross-correlation of the tip's penetration of the bodies with the force into
/// them: to some 15 ms, where the contact law does not give it.
[[nodiscard]] TimeOffset penetration_offset(const InputSeries& series, const PathView& tip,
                                            const BodyPoses& poses);

/// What slides show of the tracking's clock.
struct TrackingOffset : TimeOffset {
  bool is_ambiguous = false;  ///< not known, as poses that are off explain as much
};
/// Delay of the tracked poses against the tool, from slides: there the pushed face moves with the
/// tip, along its normal. Off the centre of mass, only faces that are flat as far as the tip slides
/// count. Not known where the tip would be farther from the pushed faces than without it.
/// `slide_half_width` [s]: see SegmentationOptions.
[[nodiscard]] TrackingOffset camera_offset(const InputSeries& series,
                                           const std::vector<BodySurface>& surfaces,
                                           const PathView& tip, std::span<const Contact> contacts,
                                           double slide_half_width);

/// The same offset without a force, by cross-correlation of a body's longest motion with the tip's.
[[nodiscard]] TimeOffset motion_offset(const InputBody& body, const BodySurface& surface,
                                       const PathView& tip,
                                       std::span<const Eigen::Vector3d> p_base_tip,
                                       double tool_radius);

}  // namespace pcavr
