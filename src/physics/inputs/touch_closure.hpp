// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/inputs/input_series.hpp"

#include "physics/inputs/body_poses.hpp"

namespace pcavr {

/// The force's clock by where the tip is when contacts begin and end: it leaves the surface where
/// it touched it, wherever the CAD model and its pose have that surface.
struct TouchClosure {
  bool fits_as_written = false;  ///< without any delay it does
  TimeOffset delay = {};         ///< of the force's stamps; known where no other one fits
  bool is_decisive = false;      ///< without that delay it does not
};
/// `max_delay` [s]: the largest that is tried.
[[nodiscard]] TouchClosure touch_closure(const Segmentation& found, const InputSeries& series,
                                         const PathView& tip, const BodyPoses& poses,
                                         double max_delay);

/// Change of the force's delay from the first half of the contacts to the second, by their touches:
/// a clock that runs at another rate than the tool's.
struct TouchDrift {
  double change = 0.0, std = 0.0;  ///< [s]
  double duration = 0.0;           ///< [s] between the middles of both halves
};
/// nullopt where the touches do not show the delays of both, or these agree.
[[nodiscard]] std::optional<TouchDrift> touch_drift(const Segmentation& found,
                                                    const InputSeries& series, const PathView& tip,
                                                    const BodyPoses& poses, double max_delay);

}  // namespace pcavr
