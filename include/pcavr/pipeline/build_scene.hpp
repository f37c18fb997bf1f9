// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/scene/scene.hpp"

namespace pcavr {

struct BuildOptions {
  double voxel_size = 0.005;           ///< of the TSDF [m]; smaller resolves more and takes longer
  double occupancy_resolution = 0.02;  ///< edge of an occupancy cell [m]
  /// Time between the frames that carve free space [s]: nearby frames see the same cells, and a
  /// planner needs no more than 10 Hz. Smaller takes longer and clears moving things sooner.
  double occupancy_interval = 0.1;
  DepthNoise depth_noise = {};  ///< noise model of the depth sensor
  bool trust_poses = false;     ///< take groundtruth.txt as given, not as a measurement
  bool skip_bad = false;        ///< leave out frames that don't decode, and count them
  /// Surface with less TSDF weight (observed in fewer frames) is left out: it may be an outlier.
  double min_weight = 2.0;
  /// Connected components of the mesh with less area than this are left out [m^2].
  double min_island = 4e-4;
  Parallelism parallelism = Parallelism::max();
};

/// From a recording to a scene in the robot's base frame: the whole pipeline. Without images the
/// scene holds what the manifest states: bodies at their poses. Fails where no frame can be placed
/// in base, where a movable object has no CAD body (without images: no pose), where a frame does
/// not decode (unless skip_bad), where the inputs contradict each other (consistency.hpp), and
/// where the frames yield no surface. Reads nothing under truth/.
[[nodiscard]] Expected<Scene> build_scene(const Recording& recording, const BuildOptions& options,
                                          const Observer& observer = {});

}  // namespace pcavr
