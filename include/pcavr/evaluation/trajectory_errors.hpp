// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/trajectory.hpp"

namespace pcavr {

/// The figures that evo prints for a list of errors; all in the errors' unit, sse in its square.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0.0, mean = 0.0, median = 0.0, std = 0.0, min = 0.0, max = 0.0, sse = 0.0;
  double p95 = 0.0;  ///< 95th percentile
};
[[nodiscard]] ErrorStatistics statistics(std::vector<double> errors);

/// The error of one pose.
struct PoseError {
  Stamp stamp;
  double translation = 0.0;  ///< [m]
  double rotation = 0.0;     ///< [rad]
};

struct TrajectoryErrors {
  std::vector<PoseError> absolute;          ///< as they stand
  std::vector<PoseError> absolute_aligned;  ///< after the best rigid motion [Umeyama 1991]
  std::vector<PoseError> relative;          ///< over `relative_step`
  Pose T_reference_estimate;                ///< that motion
  std::size_t unmatched = 0;                ///< estimates with no reference at their time
};

struct TrajectoryErrorOptions {
  Duration longest_gap = std::chrono::milliseconds(100);  ///< interpolated in the reference
  Duration relative_step = std::chrono::seconds(1);
};

/// Absolute and relative pose errors as evo defines them [Sturm et al. 2012; Grupp 2017]; the
/// reference is interpolated at the estimate's stamps.
[[nodiscard]] TrajectoryErrors trajectory_errors(const Trajectory& reference,
                                                 const Trajectory& estimate,
                                                 const TrajectoryErrorOptions& options = {});

}  // namespace pcavr
