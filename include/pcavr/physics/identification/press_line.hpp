// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/parameter.hpp"

namespace pcavr {

/// A push beside the force line that an earlier press predicts for an object at rest [paper C, SMA
/// step 2, figures 4, 5].
struct PressLine {
  /// Ratio of the rise of the measured force with the tool before the alarm to that by the press's
  /// law: a ratio of stiffnesses at equal force. 1 where the press describes this face, too.
  IdentifiedParameter ratio = {};
  /// [m] The tool's coordinate of the surface, by the force's first half.
  double surface = 0.0;
  /// [s] Paper C's mutation: the measured force leaves the press's line, by the alarm's thresholds.
  std::optional<double> t_mutation = {};
  double force = 0.0;  ///< [N] smoothed, there: paper C's breakaway force
};

/// Compares a push that broke loose with the law of a press. `ratio` is not excited where too few
/// samples precede the alarm. Thread-safe.
[[nodiscard]] PressLine compare_with_press(const ForceMotion& push, const Breakaway& found,
                                           const HuntCrossley& press,
                                           const BreakawayOptions& options = {});

/// The force [N] that the press's law predicts at each sample of a push, at rest and for a surface
/// at this coordinate of the tool [m].
[[nodiscard]] std::vector<double> press_line_force(const ForceMotion& push, double surface,
                                                   const HuntCrossley& press);

}  // namespace pcavr
