// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// The same offset by cross-correlation of the tip's penetration of the bodies with the force into
/// them: to some 15 ms, where the contact law does not give it.
[[nodiscard]] TimeOffset penetration_offset(const InputSeries& series, const PathView& tip,
                                            const BodyPoses& poses);

/// Delay of the tracked poses against the tool, from slides: there the pushed face moves with the
/// tip, along its normal. Off the centre of mass, only faces that are flat as far as the tip slides
/// count. Not known where the tip would be farther from the pushed faces than without it.
/// `slide_half_width` [s]: see SegmentationOptions.
[[nodiscard]] TimeOffset camera_offset(const InputSeries& series,
                                       const std::vector<BodySurface>& surfaces,
                                       const PathView& tip, std::span<const Contact> contacts,
                                       double slide_half_width);

/// The same offset without a force, by cross-correlation of a body's longest motion with the tip's.
[[nodiscard]] TimeOffset motion_offset(const InputBody& body, const BodySurface& surface,
                                       const PathView& tip,
                                       std::span<const Eigen::Vector3d> p_base_tip,
                                       double tool_radius);

}  // namespace pcavr
