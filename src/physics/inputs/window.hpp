// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/physics/inputs/input_findings.hpp"
#include "pcavr/physics/inputs/tip_path.hpp"

#include "physics/inputs/clock_offsets.hpp"
#include "physics/inputs/faults.hpp"
#include "physics/inputs/force_filter.hpp"
#include "physics/inputs/placement.hpp"
#include "physics/inputs/touch_closure.hpp"

namespace pcavr {

/// The knowledge before a window is analysed.
struct WindowPrior {
  TimeOffset tool_to_force = {};
  TimeOffset tool_to_camera = {};
  bool has_contacts = false;
  std::optional<ForceFilter> force_filter = {};
  std::optional<ClockDrift> force_drift = {};
};

/// The findings of one window of a stream.
struct WindowFindings {
  TimeOffset tool_to_force = {};   ///< the more certain one of the prior and this window's
  TimeOffset tool_to_camera = {};  ///< the same
  bool is_force_offset_applied = false, is_camera_offset_applied = false;
  std::optional<ForceFilter> force_filter = {};  ///< that was undone
  bool has_unknown_filter = false;
  std::optional<ClockDrift> force_drift = {};  ///< without which `tool_to_force` is stated
  std::size_t tool_outliers = 0, force_spikes = 0;
  double first_outlier = 0.0;  ///< [s]
  std::vector<double> jumps = {};
  std::vector<SaturatedInterval> saturated = {};
  double force_noise = 0.0, max_drift = 0.0;  ///< [N]
  double free_force = 0.0;                    ///< [N] far from all bodies, that was taken off
  std::vector<Contact> contacts = {};
  std::vector<ContactEvidence> evidence = {};
  UnitTouches touches = {};
  BodyPlacements placement = {};
  TouchClosure touch_closure = {};
  std::optional<InputFault> clock_fault = {};
  std::vector<FrictionRatios> friction = {};  ///< by body
  std::vector<Approach> approaches = {};      ///< by body; only where there was no contact so far
  std::vector<Pose> T_base_objects_end = {};  ///< by body
};

[[nodiscard]] WindowFindings analyse_window(const InputSeries& series,
                                            const std::vector<BodySurface>& surfaces,
                                            const WindowPrior& prior, const InputOptions& options);

}  // namespace pcavr
