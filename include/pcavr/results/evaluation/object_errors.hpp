// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/results/evaluation/options.hpp"
#include "pcavr/results/evaluation/trajectory_errors.hpp"

namespace pcavr {

/// Distances of a model's vertices from where they should be, for one pose [m].
struct ModelError {
  Stamp stamp;
  double add = 0.0;   ///< average distance, ADD [Hinterstoisser et al. 2012, eq. 6]
  double mssd = 0.0;  ///< maximum distance MSSD [Hodan et al. 2020, eq. 3]
};

/// Error of a single pose. Symmetries are not considered: a body's tags identify its sides.
/// `vertices_object` has at least one point.
[[nodiscard]] ModelError model_error(const std::vector<Eigen::Vector3f>& vertices_object,
                                     const Pose& T_base_object_reference,
                                     const Pose& T_base_object_estimate);

struct ObjectErrors {
  std::vector<ModelError> poses;  ///< of each estimate for which there is a reference
  ErrorStatistics add;
  ErrorStatistics mssd;
};

/// Errors of a trajectory: the reference is interpolated at the estimate's stamps. The same bits
/// for any Parallelism.
[[nodiscard]] ObjectErrors object_errors(const TriangleMesh& mesh_object,
                                         const Trajectory& reference, const Trajectory& estimate,
                                         const TrajectoryErrorOptions& options = {},
                                         Parallelism parallelism = {});

/// Whether the reference moves, for each stamp. The speed is that of the fastest vertex, so that a
/// rotation in place is a motion; without vertices, the origin's.
[[nodiscard]] std::vector<bool> is_moving(const Trajectory& reference,
                                          const std::vector<Eigen::Vector3f>& vertices_object,
                                          const std::vector<Stamp>& stamps,
                                          const MotionOptions& options = {},
                                          Parallelism parallelism = {});

}  // namespace pcavr
