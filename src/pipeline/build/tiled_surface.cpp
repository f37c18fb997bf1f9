// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "pcavr/base/model/mesh_simplification.hpp"
#include "pcavr/perception/reconstruction/measured_cloud.hpp"

#include "surface_builder.hpp"
#include "surface_fusion.hpp"
#include "tile_files.hpp"
#include "tile_fusion.hpp"

namespace pcavr {
namespace {

class TiledSurface final : public SurfaceBuilder {
 public:
  TiledSurface(const BuildLimits& limits, const Recording& recording, const BuildOptions& options)
      : recording_(recording),
        options_(options),
        files_(limits.fused),
        collector_(*limits.tile_size, recording, options) {}

  [[nodiscard]] bool needs_fused() const override { return false; }

  void add(const FollowedFrame& frame, const FusedFrame&) override { collector_.add(frame); }

  Expected<TriangleMesh> mesh(const SurfaceEvidence&, const Observer& observer) override {
    const TileFrames& frames = collector_.frames();
    Expected<FusedTiles> fused =
        files_.empty() ? fuse_part(frames, {}, recording_, options_, observer)
                       : read_fused_parts(files_, digest_of(format_tile_frames(frames, options_)));
    if (!fused) return fused.error();
    auto [mesh_base, cloud_base] = merge_tiles(*std::move(fused), options_);
    cloud_ = std::move(cloud_base);
    return std::move(mesh_base);
  }

  PointCloud cloud(const TriangleMesh& mesh_base, const SurfaceEvidence&) override {
    return points_near(std::exchange(cloud_, {}), mesh_base, max_mesh_distance(options_));
  }

  [[nodiscard]] std::vector<TriangleMesh> levels_of_detail(
      const TriangleMesh& mesh_base) const override {
    const double voxel = options_.fusion.voxel_size;
    const double edge =
        tile_blocks(collector_.frames().tile_size, options_) * kTsdfBlockVoxels * voxel;
    std::vector<TriangleMesh> levels{simplified_in_parts(
        mesh_base, kLevelOfDetailTriangles[0], options_.level_of_detail_error * voxel, edge)};
    add_coarser_levels(options_, levels);
    return levels;
  }

 private:
  const Recording& recording_;
  const BuildOptions& options_;
  std::vector<std::filesystem::path> files_;  ///< of the fused parts; empty: none yet
  TileFrameCollector collector_;
  PointCloud cloud_;
};

}  // namespace

std::unique_ptr<SurfaceBuilder> make_tiled_surface(const BuildLimits& limits,
                                                   const Recording& recording,
                                                   const BuildOptions& options) {
  return std::make_unique<TiledSurface>(limits, recording, options);
}

}  // namespace pcavr
