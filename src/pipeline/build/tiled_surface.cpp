// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/model/mesh_simplification.hpp"
#include "pcavr/perception/reconstruction/frame_reach.hpp"
#include "pcavr/perception/reconstruction/mesh_cleanup.hpp"

#include "prefetcher.hpp"
#include "surface_builder.hpp"
#include "surface_fusion.hpp"

namespace pcavr {
namespace {

/// A frame with all that its fusion needs besides its images.
struct PlacedFrame {
  std::size_t index = 0;  ///< in Recording::frames
  Pose T_base_camera;
  PackedMask is_dynamic;
  FrameReach reach;
};

class TiledSurface final : public SurfaceBuilder {
 public:
  TiledSurface(double tile_size, const Recording& recording, const BuildOptions& options)
      : recording_(recording),
        options_(options),
        side_(std::max(1, static_cast<int>(std::lround(tile_size / block_size())))) {}

  [[nodiscard]] bool needs_fused() const override { return false; }

  void add(const FollowedFrame& frame, const FusedFrame&) override {
    const DepthImage& depth = frame.frame.depth;
    if (!finder_) {
      finder_.emplace(on_grid(*recording_.manifest.camera, depth.width(), depth.height()),
                      fusion_options(options_));
    }
    frames_.push_back({.index = frame.frame.index,
                       .T_base_camera = frame.T_base_camera,
                       .is_dynamic = PackedMask(frame.is_dynamic),
                       .reach = finder_->reach_of(depth, frame.T_base_camera)});
    reach_.extend(finder_->bounds(frames_.back().reach));
  }

  Expected<TriangleMesh> mesh(const SurfaceEvidence& evidence, const Observer& observer) override {
    std::vector<SurfaceTile> tiles;
    std::vector<SurfaceTile> strict;  // by min_weight, where the evidence may be weaker
    const std::vector<BlockBox> boxes = tile_boxes();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Expected<void> fused = fuse(boxes[i], evidence, tiles, strict);
      if (!fused) return fused.error();
      observer.on_progress("fusing tiles", i + 1, boxes.size());
    }
    if (is_weaker(evidence)) {
      const TriangleMesh mesh = without_islands(std::move(strict));
      if (mesh.triangles.empty()) return mesh;
    }
    return without_islands(std::move(tiles));
  }

  PointCloud cloud(const TriangleMesh& mesh_base, const SurfaceEvidence&) override {
    return points_near(std::exchange(cloud_, {}), mesh_base, max_mesh_distance(options_));
  }

  [[nodiscard]] std::vector<TriangleMesh> levels_of_detail(
      const TriangleMesh& mesh_base) const override {
    const double max_error = options_.level_of_detail_error * options_.fusion.voxel_size;
    std::vector<TriangleMesh> levels{simplified_in_parts(mesh_base, kLevelOfDetailTriangles[0],
                                                         max_error, side_ * block_size())};
    add_coarser_levels(options_, levels);
    return levels;
  }

 private:
  [[nodiscard]] double block_size() const { return kTsdfBlockVoxels * options_.fusion.voxel_size; }
  [[nodiscard]] bool is_weaker(const SurfaceEvidence& evidence) const {
    return evidence.min_uncontradicted_weight < options_.min_weight;
  }

  TriangleMesh without_islands(std::vector<SurfaceTile> tiles) const {
    TriangleMesh mesh = joined(std::move(tiles));
    remove_small_components(mesh, options_.min_island);
    return mesh;
  }

  /// Squares of the grid from above that cover the reach of all frames, each over all heights.
  [[nodiscard]] std::vector<BlockBox> tile_boxes() const {
    std::vector<BlockBox> boxes;
    if (reach_.isEmpty()) return boxes;
    const double edge = side_ * block_size();
    const auto cell = [](double x, double size) { return static_cast<int>(std::floor(x / size)); };
    // One block more than the reach: the lowest one is not at the border of a tile.
    const int low = cell(reach_.min().z(), block_size()) - 1;
    const int high = cell(reach_.max().z(), block_size()) + 2;
    // Of each frame alone: sites that are far apart have nothing between them.
    std::set<std::pair<int, int>> squares;  // y, x
    for (const PlacedFrame& frame : frames_) {
      const Eigen::AlignedBox3d box = finder_->bounds(frame.reach);
      if (box.isEmpty()) continue;
      for (int y = cell(box.min().y(), edge); y <= cell(box.max().y(), edge); ++y) {
        for (int x = cell(box.min().x(), edge); x <= cell(box.max().x(), edge); ++x) {
          squares.emplace(y, x);
        }
      }
    }
    for (const auto& [y, x] : squares) {
      boxes.push_back({{x * side_, y * side_, low}, {(x + 1) * side_, (y + 1) * side_, high}});
    }
    return boxes;
  }

  /// Whether each frame sees a tile, or the blocks next to it that its surface needs.
  [[nodiscard]] std::vector<bool> seeing(const BlockBox& tile) const {
    const BlockBox kept = tile.expanded(1);
    const Eigen::AlignedBox3d box(kept.low.cast<double>() * block_size(),
                                  kept.high.cast<double>() * block_size());
    std::vector<bool> sees;
    for (const PlacedFrame& frame : frames_) sees.push_back(finder_->sees(frame.reach, box));
    return sees;
  }

  /// Appends the surface and the points of a tile.
  [[nodiscard]] Expected<void> fuse(const BlockBox& tile, const SurfaceEvidence& evidence,
                                    std::vector<SurfaceTile>& tiles,
                                    std::vector<SurfaceTile>& strict) {
    const std::vector<bool> sees = seeing(tile);
    if (std::find(sees.begin(), sees.end(), true) == sees.end()) return {};
    SurfaceFusion fusion(options_, tile);
    if (const Expected<void> fused = fuse_frames(sees, fusion); !fused) return fused;
    SurfaceTile surface = fusion.volume.extract_tile(evidence, options_.parallelism);
    if (surface.mesh.vertices.empty() && surface.mesh.triangles.empty()) return {};
    if (is_weaker(evidence)) {
      strict.push_back(fusion.volume.extract_tile({options_.min_weight, options_.min_weight},
                                                  options_.parallelism));
    }
    // With the points next to the tile, so that those at its border are no outliers.
    append(points_in(fusion.points_on(surface.mesh, evidence), tile, options_.fusion.voxel_size));
    tiles.push_back(std::move(surface));
    return {};
  }

  [[nodiscard]] Expected<void> fuse_frames(const std::vector<bool>& sees, SurfaceFusion& fusion) {
    using Decoded = Expected<std::optional<FusedFrame>>;
    std::size_t next = 0;
    const auto decode_next = [&]() -> Decoded {
      while (next < frames_.size() && !sees[next]) ++next;
      if (next == frames_.size()) return std::optional<FusedFrame>();
      const Expected<RgbdFrame> frame = decode_frame(recording_, frames_[next++].index);
      if (!frame) return frame.error();
      return std::optional(fused_frame(*frame, *recording_.manifest.camera, options_));
    };
    const auto is_last = [](const Decoded& item) { return !item || !*item; };
    Prefetcher prefetcher(decode_next, options_.parallelism);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (!sees[i]) {
        fusion.add_unseen();
        continue;
      }
      const Decoded frame = prefetcher.take(is_last);
      if (!frame) return frame.error();
      fusion.add(**frame, frames_[i].is_dynamic.unpacked(), frames_[i].T_base_camera);
    }
    return {};
  }

  void append(const PointCloud& points) {
    const auto add = [](const auto& from, auto& to) {
      to.insert(to.end(), from.begin(), from.end());
    };
    add(points.points, cloud_.points);
    add(points.normals, cloud_.normals);
    add(points.colors, cloud_.colors);
  }

  const Recording& recording_;
  const BuildOptions& options_;
  int side_;  ///< of a tile [blocks]
  std::optional<ReachFinder> finder_;
  std::vector<PlacedFrame> frames_;
  Eigen::AlignedBox3d reach_;
  PointCloud cloud_;
};

}  // namespace

std::unique_ptr<SurfaceBuilder> make_tiled_surface(double tile_size, const Recording& recording,
                                                   const BuildOptions& options) {
  return std::make_unique<TiledSurface>(tile_size, recording, options);
}

}  // namespace pcavr
