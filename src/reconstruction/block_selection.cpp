// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/block_selection.hpp"

#include <algorithm>
#include <climits>
#include <cmath>

namespace pcavr {
namespace {

constexpr std::size_t kGrainRows = 4;  // of tiles

/// Collects places, skipping those that were met just before: neighbouring rays meet the same.
class PlaceCollector {
 public:
  void add(const BlockPlace& place) {
    const std::size_t slot =
        static_cast<std::size_t>(place.x * 73 + place.y * 19 + place.z * 7) & (recent_.size() - 1);
    if (recent_[slot] == place) return;
    recent_[slot] = place;
    places_.push_back(place);
  }
  [[nodiscard]] const std::vector<BlockPlace>& places() const { return places_; }

 private:
  /// No block is met at that place: keys of BlockMap end long before.
  static constexpr BlockPlace kNowhere{INT_MIN, INT_MIN, INT_MIN};
  std::vector<BlockPlace> recent_ = std::vector<BlockPlace>(1024, kNowhere);
  std::vector<BlockPlace> places_;
};

struct BandWalker {
  Eigen::Matrix3f R_base_camera;
  Eigen::Vector3f p_base_camera;
  float block_size;
  std::vector<float> ray_x;  ///< of each column, on the plane z = 1

  /// The ray's points at depths `z_from` to `z_to`.
  void walk(const Eigen::Vector3f& ray_camera, float z_from, float z_to,
            PlaceCollector& collector) const {
    // In blocks; steps of half a block cannot jump over more than a block's corner.
    const Eigen::Vector3f ray = R_base_camera * ray_camera / block_size;
    const int steps = -floor_of(-2.0F * (z_to - z_from) * ray.norm());
    const Eigen::Vector3f step = ray * ((z_to - z_from) / static_cast<float>(steps));
    Eigen::Vector3f p = p_base_camera / block_size + z_from * ray;
    for (int i = 0; i <= steps; ++i, p += step) {
      collector.add({floor_of(p.x()), floor_of(p.y()), floor_of(p.z())});
    }
  }

  /// Without the call that std::floor is on processors before SSE4.1.
  static int floor_of(float value) {
    const int whole = static_cast<int>(value);
    return whole - (value < static_cast<float>(whole) ? 1 : 0);
  }

  void walk_tile(const FrameSurface& frame, const NoiseTables& tables, int tile_x, int tile_y,
                 PlaceCollector& collector) const {
    constexpr int kTile = FrameSurface::kTile;
    const CameraModel& camera = frame.camera;
    const DepthTile& tile = frame.tiles[static_cast<std::size_t>(tile_y * frame.tiles_x + tile_x)];
    if (!(tile.farthest > 0.0F)) return;
    // Rays a quarter of a block apart at the tile's depth are enough.
    const float quarter = 0.25F * block_size * static_cast<float>(camera.fx) / tile.farthest;
    const int apart = std::clamp(static_cast<int>(quarter), 1, kTile);
    const int u_end = std::min((tile_x + 1) * kTile, frame.camera.width);
    const int v_end = std::min((tile_y + 1) * kTile, frame.camera.height);
    for (int v = tile_y * kTile; v < v_end; v += apart) {
      const auto ray_y = static_cast<float>((v - camera.cy) / camera.fy);
      for (int u = tile_x * kTile; u < u_end; u += apart) {
        const float z = frame.depth(u, v);
        if (z <= 0.0F) continue;
        const Eigen::Vector3f ray(ray_x[static_cast<std::size_t>(u)], ray_y, 1.0F);
        const float truncation = tables.truncation(z);
        walk(ray, z - truncation, z + truncation, collector);
      }
    }
  }
};

/// Whether all that the frame sees has a place: numbers of blocks end at kMaxBlock.
bool is_addressable(const FrameSurface& frame, const Eigen::Vector3d& p_base_camera,
                    double block_size) {
  constexpr double kMaxBlock = 1 << 20;  // 21 bits with the sign, see BlockMap
  float farthest = 0.0F;
  for (const DepthTile& tile : frame.tiles) farthest = std::max(farthest, tile.farthest);
  const CameraModel& camera = frame.camera;
  const double slope_x = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double slope_y = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  // The band around a reading ends below twice its depth.
  const double reach = 2.0 * double{farthest} * std::hypot(slope_x, slope_y, 1.0);
  return p_base_camera.cwiseAbs().maxCoeff() + reach < kMaxBlock * block_size;
}

}  // namespace

std::vector<BlockPlace> places_near_surface(const FrameSurface& frame, const Pose& T_base_camera,
                                            const NoiseTables& tables, double voxel_size,
                                            Parallelism parallelism) {
  if (!is_addressable(frame, T_base_camera.translation(), kBlockSide * voxel_size)) return {};
  const auto block_size = static_cast<float>(kBlockSide * voxel_size);
  BandWalker walker{T_base_camera.rotation_matrix().cast<float>(),
                    T_base_camera.translation().cast<float>(),
                    block_size,
                    {}};
  for (int u = 0; u < frame.camera.width; ++u) {
    walker.ray_x.push_back(static_cast<float>((u - frame.camera.cx) / frame.camera.fx));
  }
  const auto tile_rows = static_cast<std::size_t>(frame.tiles_y);
  std::vector<PlaceCollector> collectors((tile_rows + kGrainRows - 1) / kGrainRows);
  parallel_for(parallelism, tile_rows, kGrainRows, [&](std::size_t begin, std::size_t end) {
    PlaceCollector& collector = collectors[begin / kGrainRows];
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      for (int x = 0; x < frame.tiles_x; ++x) {
        walker.walk_tile(frame, tables, x, row, collector);
      }
    }
  });
  // Merged in the order of rows, each place once.
  PlaceIndex known;
  std::vector<BlockPlace> places;
  for (const PlaceCollector& collector : collectors) {
    for (const BlockPlace& place : collector.places()) {
      if (known.find(place) != PlaceIndex::kNone) continue;
      known.insert(place, static_cast<std::uint32_t>(places.size()));
      places.push_back(place);
    }
  }
  return places;
}

namespace {

/// The part of the image that a sphere covers, as tiles, and what the frame holds there.
struct SphereView {
  bool in_view = false;
  bool cut_off = false;  ///< partly outside the image
  DepthTile depth;
};

SphereView look_at(const FrameSurface& frame, const Eigen::Vector3f& centre, float radius) {
  const CameraModel& camera = frame.camera;
  SphereView view;
  const float nearest = centre.z() - radius;
  if (nearest <= 0.05F) {
    // Around or behind the camera: not worth an exact answer.
    if (centre.z() + radius <= 0.0F) return view;
    view.in_view = view.cut_off = true;
    for (const DepthTile& tile : frame.tiles) {
      view.depth.nearest = std::min(view.depth.nearest, tile.nearest);
      view.depth.farthest = std::max(view.depth.farthest, tile.farthest);
      view.depth.max_free = std::max(view.depth.max_free, tile.max_free);
    }
    view.depth.min_free = 0.0F;
    return view;
  }
  const auto fx = static_cast<float>(camera.fx);
  const auto fy = static_cast<float>(camera.fy);
  const float farthest = centre.z() + radius;
  const auto low = [&](float c) { return c / (c < 0.0F ? nearest : farthest); };
  const auto high = [&](float c) { return c / (c < 0.0F ? farthest : nearest); };
  const float u0 = fx * low(centre.x() - radius) + static_cast<float>(camera.cx);
  const float u1 = fx * high(centre.x() + radius) + static_cast<float>(camera.cx);
  const float v0 = fy * low(centre.y() - radius) + static_cast<float>(camera.cy);
  const float v1 = fy * high(centre.y() + radius) + static_cast<float>(camera.cy);
  if (u1 < 0.0F || v1 < 0.0F || u0 > static_cast<float>(frame.camera.width - 1) ||
      v0 > static_cast<float>(frame.camera.height - 1)) {
    return view;
  }
  view.in_view = true;
  view.cut_off = u0 < 0.0F || v0 < 0.0F || u1 > static_cast<float>(frame.camera.width - 1) ||
                 v1 > static_cast<float>(frame.camera.height - 1);
  // Kept to the image before the cast: beside the camera a pixel is out of an int's range.
  const auto tile_of = [](float pixel, int tiles) {
    const float most = static_cast<float>(tiles * FrameSurface::kTile);
    return std::clamp(static_cast<int>(std::min(pixel, most) + 0.5F) / FrameSurface::kTile, 0,
                      tiles - 1);
  };
  for (int y = tile_of(std::max(v0, 0.0F), frame.tiles_y); y <= tile_of(v1, frame.tiles_y); ++y) {
    for (int x = tile_of(std::max(u0, 0.0F), frame.tiles_x); x <= tile_of(u1, frame.tiles_x); ++x) {
      const DepthTile& tile = frame.tiles[static_cast<std::size_t>(y * frame.tiles_x + x)];
      view.depth.nearest = std::min(view.depth.nearest, tile.nearest);
      view.depth.farthest = std::max(view.depth.farthest, tile.farthest);
      view.depth.min_free = std::min(view.depth.min_free, tile.min_free);
      view.depth.max_free = std::max(view.depth.max_free, tile.max_free);
    }
  }
  return view;
}

}  // namespace

std::vector<SeenBlock> seen_blocks(const BlockMap& map, const FrameSurface& frame,
                                   const Pose& T_base_camera, const NoiseTables& tables,
                                   double voxel_size) {
  const Pose T_camera_base = T_base_camera.inverse();
  const Eigen::Matrix3f R = T_camera_base.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_camera_base.translation().cast<float>();
  const auto voxel = static_cast<float>(voxel_size);
  const auto look = [&](const BlockPlace& place, int side_voxels) {
    // Voxels stand on the grid's points: the last one is side - 1 from the first.
    const float half = 0.5F * voxel * static_cast<float>(side_voxels - 1);
    const Eigen::Vector3f low(static_cast<float>(place.x), static_cast<float>(place.y),
                              static_cast<float>(place.z));
    const Eigen::Vector3f centre_base =
        low * (voxel * static_cast<float>(side_voxels)) + Eigen::Vector3f::Constant(half);
    const Eigen::Vector3f centre = R * centre_base + t;
    const float radius = half * 1.7321F;
    return std::pair(look_at(frame, centre, radius), std::pair(centre.z(), radius));
  };
  std::vector<SeenBlock> seen;
  const auto classify = [&](const SphereView& view, float z, float radius, SeenBlock& block) {
    if (!view.in_view) return false;
    const bool any_depth = view.depth.farthest > 0.0F;
    block.band_nearest =
        any_depth ? view.depth.nearest - tables.truncation(view.depth.nearest) : 1e9F;
    block.band_farthest =
        any_depth ? view.depth.farthest + tables.truncation(view.depth.farthest) : -1e9F;
    block.free_farthest = view.depth.max_free;
    block.wholly_free = !view.cut_off && z + radius < view.depth.min_free;
    const bool meets_band = z + radius >= block.band_nearest && z - radius <= block.band_farthest;
    return meets_band || z - radius < block.free_farthest;
  };
  for (const BlockMap::Region& region : map.regions()) {
    SeenBlock whole;
    const auto [region_view, region_range] = look(region.place, kBlockSide * BlockMap::kRegionSide);
    if (!classify(region_view, region_range.first, region_range.second, whole)) continue;
    for (const std::uint32_t number : region.blocks) {
      SeenBlock block;
      block.number = number;
      const auto [view, range] = look(map.place(number), kBlockSide);
      if (classify(view, range.first, range.second, block)) seen.push_back(block);
    }
  }
  return seen;
}

}  // namespace pcavr
