// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/inputs/input_series.hpp"

namespace pcavr {

enum class InputFaultKind {
  tool_unit,
  clock,
  body_poses,
  mesh_size,
  force_sign,
  force_axes,
  force_unit
};

/// A fault that the data show positively: another interpretation (another sign, other axes, another
/// unit, another clock) explains where the tool touched and what moved decisively better than the
/// data as written. The message states both residuals.
struct InputFault {
  InputFaultKind kind = InputFaultKind::force_sign;
  Error error;

  /// The tool's motion is usable: the tool can be replayed without the force.
  [[nodiscard]] bool is_of_force_only() const {
    return kind == InputFaultKind::force_sign || kind == InputFaultKind::force_axes ||
           kind == InputFaultKind::force_unit;
  }
};

/// Findings about the data so far.
struct InputFindings {
  std::optional<InputFault> fault = {};
  std::optional<Error> no_contact = {};  ///< the force never exceeded its noise
  TimeOffset tool_to_force = {};         ///< delay of the force's stamps; may be unknown
  bool is_force_offset_applied = false;  ///< it is significant
  TimeOffset tool_to_camera = {};        ///< delay of the tracked poses; may be unknown
  bool is_camera_offset_applied = false;
  std::size_t contacts = 0;
  std::size_t saturations = 0;               ///< intervals in which the force sensor saturated
  double first_saturation = 0.0;             ///< [s]
  std::optional<double> force_ceiling = {};  ///< [N] where it saturates
  std::size_t tool_outliers = 0, tool_jumps = 0;
  std::size_t force_spikes = 0;
  double force_noise = 0.0;                ///< [N] of one sample
  double max_drift = 0.0;                  ///< [N] of the bias that was removed
  double suspected_turn = 0.0;             ///< [rad] of the force, of which a warning speaks; or 0
  std::vector<std::string> notes = {};     ///< lines for a report: outliers, jumps, saturation
  std::vector<std::string> warnings = {};  ///< of the notes: data that contradict each other

  /// The time to subtract from the stamps of the force or of the tracking [s].
  [[nodiscard]] double force_shift() const {
    return is_force_offset_applied ? tool_to_force.offset : 0.0;
  }
  [[nodiscard]] double camera_shift() const {
    return is_camera_offset_applied ? tool_to_camera.offset : 0.0;
  }
};

/// "t = 12.345 s".
[[nodiscard]] std::string at_time(double t);

}  // namespace pcavr
