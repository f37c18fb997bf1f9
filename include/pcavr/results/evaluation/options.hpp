// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace pcavr {

struct OptionSection;  // core/options.hpp

// Defaults, ranges, and what goes wrong at their ends: src/results/evaluation/options.cpp.
// Thresholds that a report names (completeness within 5 mm, recovery to below 3 mm, events within
// 0.5 s) are part of a metric's definition, so that reports can be compared, and no options.

/// Errors of a trajectory ("evaluation.trajectories").
struct TrajectoryErrorOptions {
  TrajectoryErrorOptions();
  double max_gap;        ///< [s] of the reference, up to which it is interpolated
  double relative_step;  ///< [s] between the poses of a relative error, +-10 %
};

/// Speeds that count as moving: the same hysteresis as that of the phases in `truth/`
/// ("evaluation.motion").
struct MotionOptions {
  MotionOptions();
  double speed_to_start;  ///< [m/s] moving from this speed on
  double speed_to_stop;   ///< [m/s] until slower than this
  double span;            ///< [s] of the mean speed, centred
};

/// Limits of the surfaces that a depth camera can see ("evaluation.views").
struct ViewOptions {
  ViewOptions();
  double min_depth;      ///< [m] along the optical axis
  double max_depth;      ///< [m] along the optical axis
  double max_incidence;  ///< [rad] between ray and surface normal
  int max_views;         ///< poses of the camera that are tested
};

/// Errors of a surface ("evaluation.surfaces").
struct SurfaceErrorOptions {
  SurfaceErrorOptions();
  double sample_spacing;  ///< [m] between samples on either surface
  std::uint64_t seed;     ///< of the samples
};

/// Errors of rendered forces ("evaluation.forces").
struct ForceErrorOptions {
  ForceErrorOptions();
  double min_relative_force;  ///< [N] measured, from which on a relative error is computed
  double contact_gap;         ///< [s] between samples of different contacts
  double approach_time;       ///< [s] of the tip's mean speed before a contact
  double peak_half_width;     ///< [s] over which a peak's two forces are averaged
};

struct EvaluationOptions {
  TrajectoryErrorOptions trajectories;
  MotionOptions motion;
  ViewOptions views;
  SurfaceErrorOptions surfaces;
  ForceErrorOptions forces;
};

[[nodiscard]] OptionSection section_of(TrajectoryErrorOptions& options);
[[nodiscard]] OptionSection section_of(MotionOptions& options);
[[nodiscard]] OptionSection section_of(ViewOptions& options);
[[nodiscard]] OptionSection section_of(SurfaceErrorOptions& options);
[[nodiscard]] OptionSection section_of(ForceErrorOptions& options);
/// All of them.
[[nodiscard]] std::vector<OptionSection> sections_of(EvaluationOptions& options);

}  // namespace pcavr
