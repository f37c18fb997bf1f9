// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/perception/reconstruction/cloud_filter.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"
#include "pcavr/perception/scene/occupancy_map.hpp"
#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/perception/scene/support_plane.hpp"
#include "pcavr/perception/texture/texture_options.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/pipeline/build/build_options.cpp for meanings, ranges and defaults.
/// `perception.depth_noise` applies to the fusion too, in place of the one in `fusion`, and limits
/// the occupancy's range.
struct BuildOptions {
  BuildOptions();
  explicit BuildOptions(double voxel_size, Parallelism parallelism = Parallelism::max());

  PerceptionOptions perception;
  TsdfOptions fusion;
  OutlierOptions outliers;
  OccupancyOptions occupancy;
  SupportPlaneOptions support_planes;
  TextureOptions texture;
  double occupancy_interval;     ///< [s]
  double min_weight;             ///< [frames]
  double frames_per_weight;      ///< [frames]
  double min_island;             ///< [m^2]
  double level_of_detail_error;  ///< [voxels]
  double max_surface_distance;   ///< [m]
  bool trust_poses = false;      ///< take groundtruth.txt as given, not as a measurement
  bool skip_bad = false;         ///< leave out frames that don't decode, and count them
  Parallelism parallelism = Parallelism::max();
};

/// The options "build", and all that only building a scene uses; they refer to `options`.
[[nodiscard]] OptionSection section_of(BuildOptions& options);
[[nodiscard]] std::vector<OptionSection> sections_of(BuildOptions& options);

/// The evidence that the surface of `frames` fused frames needs. A surface that no frame
/// contradicts needs one frame in each `frames_per_weight`, at most `min_weight`: errors of single
/// frames add up with the frames, while parts that few frames see get fewer.
[[nodiscard]] SurfaceEvidence surface_evidence(const BuildOptions& options, std::size_t frames);

/// Builds a scene in the robot's base frame from a recording: the whole pipeline. Without images
/// the scene holds what the manifest states: bodies at their poses. Fails where no frame can be
/// placed in base, where a movable object has no CAD body (without images: no pose), where a frame
/// does not decode (unless skip_bad), where the inputs contradict each other (consistency.hpp), and
/// where the frames yield no surface. Reads nothing under truth/.
[[nodiscard]] Expected<Scene> build_scene(const Recording& recording, const BuildOptions& options,
                                          const Observer& observer = {});

}  // namespace pcavr
