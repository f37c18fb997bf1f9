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
  double voxel_size = 0.005;           ///< of the mesh [m]; smaller shows more, and costs more
  double occupancy_resolution = 0.02;  ///< edge of an occupancy cell [m]
  /// Free space is carved from one frame in this time [s]: nearby frames see the same cells, and a
  /// planner wants no more than 10 Hz. Smaller costs more and clears moving things sooner.
  double occupancy_interval = 0.1;
  DepthNoise depth_noise = {};  ///< of the sensor that recorded
  bool trust_poses = false;     ///< take groundtruth.txt as given, not as a measurement
  bool skip_bad = false;        ///< leave out frames that don't decode, and count them
  /// Surface that fewer frames than this agree on is left out: single readings lie.
  double min_weight = 2.0;
  /// Connected parts of the mesh with less area than this are left out [m^2].
  double min_island = 4e-4;
  Parallelism parallelism = Parallelism::max();
};

/// From a recording to a scene in the robot's base frame: the whole chain. Without images it is
/// what the manifest states: bodies at their poses. Fails where no frame can be placed in base,
/// where a movable object has no CAD body (without images: no pose), where a frame does not decode
/// (unless skip_bad), where the inputs contradict each other (consistency.hpp), and where the
/// frames make no surface. Reads nothing under truth/.
[[nodiscard]] Expected<Scene> build_scene(const Recording& recording, const BuildOptions& options,
                                          const Observer& observer = {});

}  // namespace pcavr
