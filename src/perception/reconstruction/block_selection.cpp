// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/block_selection.hpp"

#include <algorithm>
#include <climits>
#include <cmath>

namespace pcavr {
namespace {

constexpr std::size_t kSelectionGrainRows = 4;  // of tiles; amortises the scheduling of a task

/// Collects block coordinates, skipping recent duplicates: neighbouring rays pass the same blocks.
class BlockCollector {
 public:
  void add(const BlockCoordinates& block) {
    const std::size_t slot =
        static_cast<std::size_t>(block.x * 73 + block.y * 19 + block.z * 7) & (recent_.size() - 1);
    if (recent_[slot] == block) return;
    recent_[slot] = block;
    blocks_.push_back(block);
  }
  [[nodiscard]] const std::vector<BlockCoordinates>& blocks() const { return blocks_; }

 private:
  /// A block outside the range of BlockMap's keys.
  static constexpr BlockCoordinates kInvalid{INT_MIN, INT_MIN, INT_MIN};
  std::vector<BlockCoordinates> recent_ = std::vector<BlockCoordinates>(1024, kInvalid);
  std::vector<BlockCoordinates> blocks_;
};

/// Marches rays through the truncation band around each measured depth.
struct BandTracer {
  Eigen::Matrix3f R_base_camera;
  Eigen::Vector3f p_base_camera;
  float block_size;
  std::vector<float> ray_x;  ///< of each column, on the plane z = 1

  /// Marches along a ray from depth `z_from` to `z_to`.
  void trace(const Eigen::Vector3f& ray_camera, float z_from, float z_to,
             BlockCollector& collector) const {
    // The ray is in units of blocks; steps of half a block skip at most the corner of a block.
    const Eigen::Vector3f ray = R_base_camera * ray_camera / block_size;
    const int steps = -floor_of(-2.0F * (z_to - z_from) * ray.norm());
    const Eigen::Vector3f step = ray * ((z_to - z_from) / static_cast<float>(steps));
    Eigen::Vector3f p = p_base_camera / block_size + z_from * ray;
    for (int i = 0; i <= steps; ++i, p += step) {
      collector.add({floor_of(p.x()), floor_of(p.y()), floor_of(p.z())});
    }
  }

  /// Faster than std::floor, which is a function call before SSE4.1.
  static int floor_of(float value) {
    const int whole = static_cast<int>(value);
    return whole - (value < static_cast<float>(whole) ? 1 : 0);
  }

  void trace_tile(const FrameSurface& frame, const NoiseTables& tables, int tile_x, int tile_y,
                  BlockCollector& collector) const {
    constexpr int kTile = FrameSurface::kTile;
    const CameraModel& camera = frame.camera;
    const DepthTile& tile = frame.tiles[static_cast<std::size_t>(tile_y * frame.tiles_x + tile_x)];
    if (!(tile.max_depth > 0.0F)) return;
    // A ray spacing of a quarter block at the tile's depth is sufficient.
    const float spacing = 0.25F * block_size * static_cast<float>(camera.fx) / tile.max_depth;
    const int stride = std::clamp(static_cast<int>(spacing), 1, kTile);
    const int u_end = std::min((tile_x + 1) * kTile, frame.camera.width);
    const int v_end = std::min((tile_y + 1) * kTile, frame.camera.height);
    for (int v = tile_y * kTile; v < v_end; v += stride) {
      const auto ray_y = static_cast<float>((v - camera.cy) / camera.fy);
      for (int u = tile_x * kTile; u < u_end; u += stride) {
        const float z = frame.depth(u, v);
        if (z <= 0.0F) continue;
        const Eigen::Vector3f ray(ray_x[static_cast<std::size_t>(u)], ray_y, 1.0F);
        const float truncation = tables.truncation(z);
        trace(ray, z - truncation, z + truncation, collector);
      }
    }
  }
};

/// Whether all blocks that the frame may observe have coordinates within kMaxBlock.
bool is_addressable(const FrameSurface& frame, const Eigen::Vector3d& p_base_camera,
                    double block_size) {
  constexpr double kMaxBlock = 1 << 20;  // 21 bits with the sign, see BlockMap
  float max_depth = 0.0F;
  for (const DepthTile& tile : frame.tiles) max_depth = std::max(max_depth, tile.max_depth);
  const CameraModel& camera = frame.camera;
  const double slope_x = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double slope_y = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  // The truncation band ends below twice the measured depth.
  const double reach = 2.0 * double{max_depth} * std::hypot(slope_x, slope_y, 1.0);
  return p_base_camera.cwiseAbs().maxCoeff() + reach < kMaxBlock * block_size;
}

}  // namespace

std::vector<BlockCoordinates> blocks_near_surface(const FrameSurface& frame,
                                                  const Pose& T_base_camera,
                                                  const NoiseTables& tables, double voxel_size,
                                                  Parallelism parallelism) {
  if (!is_addressable(frame, T_base_camera.translation(), kBlockSide * voxel_size)) return {};
  const auto block_size = static_cast<float>(kBlockSide * voxel_size);
  BandTracer tracer{T_base_camera.rotation_matrix().cast<float>(),
                    T_base_camera.translation().cast<float>(),
                    block_size,
                    {}};
  for (int u = 0; u < frame.camera.width; ++u) {
    tracer.ray_x.push_back(static_cast<float>((u - frame.camera.cx) / frame.camera.fx));
  }
  const auto tile_rows = static_cast<std::size_t>(frame.tiles_y);
  std::vector<BlockCollector> collectors((tile_rows + kSelectionGrainRows - 1) /
                                         kSelectionGrainRows);
  parallel_for(parallelism, tile_rows, kSelectionGrainRows,
               [&](std::size_t begin, std::size_t end) {
                 BlockCollector& collector = collectors[begin / kSelectionGrainRows];
                 for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
                   for (int x = 0; x < frame.tiles_x; ++x) {
                     tracer.trace_tile(frame, tables, x, row, collector);
                   }
                 }
               });
  // Merged in row order, without duplicates.
  BlockHashTable known;
  std::vector<BlockCoordinates> blocks;
  for (const BlockCollector& collector : collectors) {
    for (const BlockCoordinates& block : collector.blocks()) {
      if (known.find(block) != BlockHashTable::kNone) continue;
      known.insert(block, static_cast<std::uint32_t>(blocks.size()));
      blocks.push_back(block);
    }
  }
  return blocks;
}

namespace {

/// The projection of a bounding sphere into the image, and the depth range of the tiles it covers.
struct SphereView {
  bool in_view = false;
  bool is_clipped = false;  ///< partly outside the image
  DepthTile depth;
};

SphereView project_sphere(const FrameSurface& frame, const Eigen::Vector3f& centre, float radius) {
  const CameraModel& camera = frame.camera;
  SphereView view;
  const float min_depth = centre.z() - radius;
  if (min_depth <= 0.05F) {
    // Contains the camera or is behind it: conservatively takes all tiles.
    if (centre.z() + radius <= 0.0F) return view;
    view.in_view = view.is_clipped = true;
    for (const DepthTile& tile : frame.tiles) {
      view.depth.min_depth = std::min(view.depth.min_depth, tile.min_depth);
      view.depth.max_depth = std::max(view.depth.max_depth, tile.max_depth);
      view.depth.max_free = std::max(view.depth.max_free, tile.max_free);
    }
    view.depth.min_free = 0.0F;
    return view;
  }
  const auto fx = static_cast<float>(camera.fx);
  const auto fy = static_cast<float>(camera.fy);
  const float max_depth = centre.z() + radius;
  const auto low = [&](float c) { return c / (c < 0.0F ? min_depth : max_depth); };
  const auto high = [&](float c) { return c / (c < 0.0F ? max_depth : min_depth); };
  const float u0 = fx * low(centre.x() - radius) + static_cast<float>(camera.cx);
  const float u1 = fx * high(centre.x() + radius) + static_cast<float>(camera.cx);
  const float v0 = fy * low(centre.y() - radius) + static_cast<float>(camera.cy);
  const float v1 = fy * high(centre.y() + radius) + static_cast<float>(camera.cy);
  if (u1 < 0.0F || v1 < 0.0F || u0 > static_cast<float>(frame.camera.width - 1) ||
      v0 > static_cast<float>(frame.camera.height - 1)) {
    return view;
  }
  view.in_view = true;
  view.is_clipped = u0 < 0.0F || v0 < 0.0F || u1 > static_cast<float>(frame.camera.width - 1) ||
                    v1 > static_cast<float>(frame.camera.height - 1);
  // Close to the image plane z = 0 a pixel may exceed an int, or be no number: then all tiles
  // count.
  const auto first_tile = [](float pixel, int tiles) {
    const float max_pixel = static_cast<float>(tiles * FrameSurface::kTile);
    const float clamped = pixel > 0.0F ? std::min(pixel, max_pixel) : 0.0F;
    return std::min(static_cast<int>(clamped + 0.5F) / FrameSurface::kTile, tiles - 1);
  };
  const auto last_tile = [&first_tile](float pixel, int tiles) {
    return pixel <= static_cast<float>(tiles * FrameSurface::kTile) ? first_tile(pixel, tiles)
                                                                    : tiles - 1;
  };
  const int last_x = last_tile(u1, frame.tiles_x);
  const int last_y = last_tile(v1, frame.tiles_y);
  for (int y = first_tile(v0, frame.tiles_y); y <= last_y; ++y) {
    for (int x = first_tile(u0, frame.tiles_x); x <= last_x; ++x) {
      const DepthTile& tile = frame.tiles[static_cast<std::size_t>(y * frame.tiles_x + x)];
      view.depth.min_depth = std::min(view.depth.min_depth, tile.min_depth);
      view.depth.max_depth = std::max(view.depth.max_depth, tile.max_depth);
      view.depth.min_free = std::min(view.depth.min_free, tile.min_free);
      view.depth.max_free = std::max(view.depth.max_free, tile.max_free);
    }
  }
  return view;
}

}  // namespace

std::vector<VisibleBlock> visible_blocks(const BlockMap& map, const FrameSurface& frame,
                                         const Pose& T_base_camera, const NoiseTables& tables,
                                         double voxel_size) {
  const Pose T_camera_base = T_base_camera.inverse();
  const Eigen::Matrix3f R = T_camera_base.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_camera_base.translation().cast<float>();
  const auto voxel = static_cast<float>(voxel_size);
  const auto project_block = [&](const BlockCoordinates& block, int side_voxels) {
    // Voxels are grid points: the last one is side - 1 from the first.
    const float half = 0.5F * voxel * static_cast<float>(side_voxels - 1);
    const Eigen::Vector3f low(static_cast<float>(block.x), static_cast<float>(block.y),
                              static_cast<float>(block.z));
    const Eigen::Vector3f centre_base =
        low * (voxel * static_cast<float>(side_voxels)) + Eigen::Vector3f::Constant(half);
    const Eigen::Vector3f centre = R * centre_base + t;
    const float radius = half * 1.7321F;
    return std::pair(project_sphere(frame, centre, radius), std::pair(centre.z(), radius));
  };
  std::vector<VisibleBlock> visible;
  if (frame.tiles.empty()) return visible;  // less than 2 x 2 pixels
  const auto classify = [&](const SphereView& view, float z, float radius, VisibleBlock& block) {
    if (!view.in_view) return false;
    const bool any_depth = view.depth.max_depth > 0.0F;
    block.min_band_depth =
        any_depth ? view.depth.min_depth - tables.truncation(view.depth.min_depth) : 1e9F;
    block.max_band_depth =
        any_depth ? view.depth.max_depth + tables.truncation(view.depth.max_depth) : -1e9F;
    block.max_free_depth = view.depth.max_free;
    block.is_entirely_free = !view.is_clipped && z + radius < view.depth.min_free;
    const bool meets_band =
        z + radius >= block.min_band_depth && z - radius <= block.max_band_depth;
    return meets_band || z - radius < block.max_free_depth;
  };
  for (const BlockMap::Region& region : map.regions()) {
    VisibleBlock whole;
    const auto [region_view, region_range] =
        project_block(region.coordinates, kBlockSide * BlockMap::kRegionSide);
    if (!classify(region_view, region_range.first, region_range.second, whole)) continue;
    for (const std::uint32_t number : region.blocks) {
      VisibleBlock block;
      block.number = number;
      const auto [view, range] = project_block(map.coordinates(number), kBlockSide);
      if (classify(view, range.first, range.second, block)) visible.push_back(block);
    }
  }
  return visible;
}

}  // namespace pcavr
