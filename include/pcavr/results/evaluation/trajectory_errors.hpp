// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/results/evaluation/options.hpp"

namespace pcavr {

/// The statistics that evo prints for a list of errors; all in the errors' unit, sse in its square.
/// All are 0 where there are no errors (count 0).
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double std = 0.0;  ///< of the population: divided by count
  double min = 0.0;
  double max = 0.0;
  double sse = 0.0;
  double p95 = 0.0;  ///< 95th percentile, interpolated; not in evo
};

[[nodiscard]] ErrorStatistics statistics(std::vector<double> errors);

/// The value below which a share (0 to 1) of the errors lies, interpolated between neighbours.
/// `ascending` holds at least one error.
[[nodiscard]] double quantile(const std::vector<double>& ascending, double share);

/// The error of one pose.
struct PoseError {
  Stamp stamp;               ///< of the estimate; a relative error's is that of its second pose
  double translation = 0.0;  ///< [m]
  double rotation = 0.0;     ///< [rad], in [0, pi]
};

struct TrajectoryErrors {
  std::vector<PoseError> absolute;          ///< without alignment
  std::vector<PoseError> absolute_aligned;  ///< after T_reference_estimate; empty without it
  std::vector<PoseError> relative;          ///< over `relative_step` (RPE)
  std::vector<PoseError> step;              ///< from each matched pose to the next
  /// Least-squares rigid alignment of the estimate's positions to the reference's [Umeyama 1991].
  /// Nothing where it is not unique, because the positions lie on a line or in a point: a fixed
  /// camera, an object at rest.
  std::optional<Pose> T_reference_estimate;
  std::size_t unmatched =
      0;  ///< estimates outside the reference's time span, or inside a gap of it
};

/// Absolute and relative pose errors (APE/ATE, RPE) as evo defines them [Sturm et al. 2012, eq. 1
/// and 2; evo's `ape` and `rpe`, all pairs, translation part and angle]; the reference is
/// interpolated at the estimate's stamps. Alignment: rotation and translation, no scale [Umeyama
/// 1991].
[[nodiscard]] TrajectoryErrors trajectory_errors(const Trajectory& reference,
                                                 const Trajectory& estimate,
                                                 const TrajectoryErrorOptions& options = {});

/// The columns of a list of errors.
[[nodiscard]] std::vector<double> translations(const std::vector<PoseError>& errors);
[[nodiscard]] std::vector<double> rotations(const std::vector<PoseError>& errors);

}  // namespace pcavr
