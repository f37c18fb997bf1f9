// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace pcavr
