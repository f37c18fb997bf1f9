// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/core/parallel.hpp"
#include "pcavr/evaluation/trajectory_errors.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

/// A body and the poses that it had.
struct MovedBody {
  TriangleMesh mesh_object;  ///< closed, outward winding
  std::vector<Pose> T_base_object;
};

/// From where the static surfaces could be seen, and what stood before them.
struct Views {
  CameraModel camera;
  std::vector<Pose> T_base_camera;  ///< true poses, one a view
  std::vector<MovedBody> bodies;    ///< movable ones, each with one pose a view
  // Within these a depth camera of the structured-light or time-of-flight kind measures: a surface
  // outside them was looked at, but not seen.
  double nearest = 0.4;            ///< along the optical axis [m]
  double farthest = 4.0;           ///< along the optical axis [m]
  double max_incidence = 1.30900;  ///< between ray and surface normal [rad], 75 degrees
};

struct MeshErrors {
  ErrorStatistics accuracy;  ///< samples of the mesh -> nearest point of the truth [m]
  /// Of the truth's samples that were seen, the share that lies near the mesh; 0 where none was.
  double completeness_5mm = 0.0;
  double completeness_10mm = 0.0;
  double share_not_explained = 0.0;  ///< of the mesh's area, farther than 20 mm from the truth
  /// The distances themselves, ascending [m].
  std::vector<double> mesh_to_truth;
  std::vector<double> seen_truth_to_mesh;
};

struct SurfaceErrorOptions {
  /// Between samples on either surface [m], > 0. Halving it costs four times the time; a share is
  /// known to about one sample in (area / spacing^2).
  double sample_spacing = 0.005;
  std::uint64_t seed = 1;
};

/// Compares a mesh with the true static surfaces. With `views`, only such parts of the truth count
/// for completeness as some view could see: inside the image and the range, not hidden by the truth
/// itself or by a body, not grazing. Without, all of it counts. The same bits for any Parallelism.
/// Throws ContractError where the truth has no surface, or a body not one pose a view.
[[nodiscard]] MeshErrors mesh_errors(const TriangleMesh& truth_base, const TriangleMesh& mesh_base,
                                     const std::optional<Views>& views,
                                     const SurfaceErrorOptions& options, Parallelism parallelism);

/// Share of a mesh's area that a movable body left behind: farther than 10 mm from every true
/// static surface, and inside or within 10 mm of a body at one of its poses. What noise and
/// smoothing do to a static surface does not count.
[[nodiscard]] double share_left_behind(const TriangleMesh& truth_base,
                                       const TriangleMesh& mesh_base,
                                       const std::vector<MovedBody>& bodies,
                                       const SurfaceErrorOptions& options, Parallelism parallelism);

}  // namespace pcavr
