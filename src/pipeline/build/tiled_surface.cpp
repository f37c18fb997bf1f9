// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "pcavr/base/core/freed_memory.hpp"
#include "pcavr/base/model/mesh_simplification.hpp"
#include "pcavr/perception/reconstruction/measured_cloud.hpp"

#include "surface_builder.hpp"
#include "surface_fusion.hpp"
#include "tile_files.hpp"
#include "tile_fusion.hpp"

namespace pcavr {
namespace {

/// The surface of tiles, wherever they are from.
class TiledSurface : public SurfaceBuilder {
 public:
  TiledSurface(double tile_size, const BuildOptions& options)
      : options_(options),
        tile_edge_(tile_blocks(tile_size, options) * kTsdfBlockVoxels * options.fusion.voxel_size) {
  }

  [[nodiscard]] bool needs_fused() const override { return false; }

  Expected<TriangleMesh> mesh(const SurfaceEvidence&, const Observer& observer) override {
    Expected<FusedTiles> fused = take_tiles(observer);
    if (!fused) return fused.error();
    return_freed_memory();
    auto [mesh_base, points_base] = merge_tiles(*std::move(fused), options_);
    points_base_ = std::move(points_base);
    return std::move(mesh_base);
  }

  PointCloud cloud(const TriangleMesh& mesh_base, const SurfaceEvidence&) override {
    return points_near(std::exchange(points_base_, {}), mesh_base, max_mesh_distance(options_));
  }

  [[nodiscard]] std::vector<TriangleMesh> levels_of_detail(
      const TriangleMesh& mesh_base) const override {
    return_freed_memory();
    std::vector<TriangleMesh> levels{simplified_in_parts(
        mesh_base, kLevelOfDetailTriangles[0],
        options_.level_of_detail_error * options_.fusion.voxel_size, tile_edge_)};
    add_coarser_levels(options_, levels);
    return_freed_memory();
    return levels;
  }

 private:
  [[nodiscard]] virtual Expected<FusedTiles> take_tiles(const Observer& observer) = 0;

  const BuildOptions& options_;
  double tile_edge_;                     ///< [m]
  std::vector<PointCloud> points_base_;  ///< by tile
};

/// Fuses the tiles of the frames that are added.
class CollectedSurface final : public TiledSurface {
 public:
  CollectedSurface(double tile_size, const Recording& recording, const BuildOptions& options)
      : TiledSurface(tile_size, options),
        recording_(recording),
        options_(options),
        collector_(tile_size, recording, options) {}

  void add(const FollowedFrame& frame, const FusedFrame&) override { collector_.add(frame); }

 private:
  Expected<FusedTiles> take_tiles(const Observer& observer) override {
    FusedTiles fused;
    const Expected<bool> has_agreed_surface =
        fuse_part(collector_.frames(), {}, recording_, options_, observer, [&](FusedTile tile) {
          fused.add(std::move(tile));
          return Expected<void>();
        });
    if (!has_agreed_surface) return has_agreed_surface.error();
    fused.has_agreed_surface = *has_agreed_surface;
    return fused;
  }

  const Recording& recording_;
  const BuildOptions& options_;
  TileFrameCollector collector_;
};

/// Reads tiles that other processes fused.
class FusedSurface final : public TiledSurface {
 public:
  FusedSurface(double tile_size, FusedParts parts, const BuildOptions& options)
      : TiledSurface(tile_size, options), parts_(std::move(parts)) {}

  void add(const FollowedFrame&, const FusedFrame&) override {}

 private:
  Expected<FusedTiles> take_tiles(const Observer&) override { return parts_.read(); }

  FusedParts parts_;
};

}  // namespace

std::unique_ptr<SurfaceBuilder> make_tiled_surface(double tile_size, const Recording& recording,
                                                   const BuildOptions& options) {
  return std::make_unique<CollectedSurface>(tile_size, recording, options);
}

std::unique_ptr<SurfaceBuilder> make_fused_surface(double tile_size, FusedParts parts,
                                                   const BuildOptions& options) {
  return std::make_unique<FusedSurface>(tile_size, std::move(parts), options);
}

}  // namespace pcavr
