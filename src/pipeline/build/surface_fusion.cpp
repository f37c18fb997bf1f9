// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "surface_fusion.hpp"

#include <cmath>
#include <future>

#include "pcavr/base/model/mesh_simplification.hpp"
#include "pcavr/perception/reconstruction/cloud_filter.hpp"

#include "pipeline/replay/async_if_parallel.hpp"

namespace pcavr {

SurfaceFusion::SurfaceFusion(const BuildOptions& options, const std::optional<BlockBox>& part)
    : volume(fusion_options(options), part),
      cloud(options.fusion.voxel_size, options.perception.depth_noise, part),
      options_(options) {}

void SurfaceFusion::add(const FusedFrame& frame, const MaskImage& is_dynamic,
                        const Pose& T_base_camera) {
  // Averaging runs in parallel with the fusion, because neither of them uses both cores fully.
  std::future<void> averaged = async_if_parallel(options_.parallelism, [&] {
    cloud.add(frame.depth, frame.color, is_dynamic, frame.camera, T_base_camera);
  });
  volume.integrate(frame.depth, frame.color, is_dynamic, frame.camera, T_base_camera,
                   options_.parallelism);
  averaged.get();
}

void SurfaceFusion::add_unseen() {
  volume.integrate_unseen();
  cloud.add_unseen();
}

PointCloud SurfaceFusion::points_on(const TriangleMesh& mesh_base,
                                    const SurfaceEvidence& evidence) const {
  const PointCloud points =
      cloud.points(static_cast<int>(std::ceil(evidence.min_uncontradicted_weight)));
  return remove_outliers(points_near(points, mesh_base, max_mesh_distance(options_)),
                         options_.outliers);
}

double max_mesh_distance(const BuildOptions& options) { return 2.0 * options.fusion.voxel_size; }

void add_coarser_levels(const BuildOptions& options, std::vector<TriangleMesh>& levels) {
  double max_error = options.level_of_detail_error * options.fusion.voxel_size;
  for (std::size_t i = 1; i < std::size(kLevelOfDetailTriangles); ++i) {
    max_error *= 4.0;
    levels.push_back(simplified(levels.back(), kLevelOfDetailTriangles[i], max_error));
  }
}

}  // namespace pcavr
