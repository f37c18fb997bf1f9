// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/core/parallel.hpp"
#include "pcavr/evaluation/trajectory_errors.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/mesh.hpp"
#include "pcavr/model/cad_model.hpp"

namespace pcavr {

struct MeshErrors {
  ErrorStatistics accuracy;       ///< samples of the mesh -> nearest point of the truth [m]
  double completeness_5mm = 0.0;  ///< share of the truth that was seen, within 5 mm of the mesh
  double completeness_10mm = 0.0;
  double share_not_explained = 0.0;  ///< of the mesh's area, farther than 20 mm from the truth
};

struct MeshErrorOptions {
  double sample_spacing = 0.004;  ///< between samples on either surface [m]
  std::uint64_t seed = 1;
};

/// Compares a mesh with the truth. Where the camera's true poses are given, only such parts of the
/// truth count for completeness as some frame could see (in its view, not hidden, not grazing).
[[nodiscard]] MeshErrors mesh_errors(const TriangleMesh& truth_base, const TriangleMesh& mesh_base,
                                     const std::optional<CameraModel>& camera,
                                     const std::vector<Pose>& T_base_camera,
                                     const MeshErrorOptions& options, Parallelism parallelism);

/// Share of a mesh's area that lies on or in the bodies given, at any of the poses: what should
/// have been taken out of a static mesh. Surfaces that the truth explains do not count.
[[nodiscard]] double share_left_behind(const TriangleMesh& mesh_base,
                                       const TriangleMesh& truth_base,
                                       const std::vector<TriangleMesh>& bodies_base);

/// Object pose errors over a model's vertices: ADD, mean distance [Hinterstoisser et al. 2012],
/// and MSSD, largest distance [Hodan et al. 2020], without symmetries [m].
struct ObjectErrors {
  ErrorStatistics add;
  ErrorStatistics mssd;
};
[[nodiscard]] ObjectErrors object_errors(const TriangleMesh& mesh_object,
                                         const Trajectory& reference, const Trajectory& estimate,
                                         const TrajectoryErrorOptions& options = {});

}  // namespace pcavr
