// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/results/evaluation/options.hpp"
#include "pcavr/results/evaluation/trajectory_errors.hpp"

namespace pcavr {

/// A body and its poses over time.
struct MovedBody {
  TriangleMesh mesh_object;  ///< closed, outward winding
  std::vector<Pose> T_base_object;
};

/// Camera views of the static surfaces, and the bodies that may occlude them.
struct Views {
  CameraModel camera;
  std::vector<Pose> T_base_camera;  ///< true poses, one per view
  std::vector<MovedBody> bodies;    ///< movable, each with one pose per view
  ViewOptions options = {};         ///< a surface outside these limits counts as not seen
};

struct MeshErrors {
  ErrorStatistics accuracy;  ///< samples of the mesh -> nearest point of the truth [m]
  /// Share of the seen truth samples that lie near the mesh; 0 where none was seen.
  double completeness_5mm = 0.0;
  double completeness_10mm = 0.0;
  double share_not_explained = 0.0;  ///< of the mesh's area, farther than 20 mm from the truth
  /// The distances themselves, ascending [m].
  std::vector<double> mesh_to_truth;
  std::vector<double> seen_truth_to_mesh;
};

/// Compares a mesh with the true static surfaces. With `views`, completeness counts only the parts
/// of the truth that some view could see: inside the image and the range, not occluded by the truth
/// itself or by a body, not at grazing incidence. Without, all of it counts. The same bits for any
/// Parallelism. Throws ContractError where the truth has no surface, or a body not one pose per
/// view.
[[nodiscard]] MeshErrors mesh_errors(const TriangleMesh& truth_base, const TriangleMesh& mesh_base,
                                     const std::optional<Views>& views,
                                     const SurfaceErrorOptions& options, Parallelism parallelism);

/// Share of a mesh's area that is a residue of a movable body (ghost surface): farther than 10 mm
/// from every true static surface, and inside or within 10 mm of a body at one of its poses. Errors
/// of static surfaces by noise and smoothing do not count.
[[nodiscard]] double share_left_behind(const TriangleMesh& truth_base,
                                       const TriangleMesh& mesh_base,
                                       const std::vector<MovedBody>& bodies,
                                       const SurfaceErrorOptions& options, Parallelism parallelism);

}  // namespace pcavr
