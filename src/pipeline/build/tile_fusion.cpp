// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tile_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/core.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/perception/reconstruction/mesh_cleanup.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

#include "pipeline/jobs/sha256.hpp"
#include "prefetcher.hpp"
#include "surface_fusion.hpp"

namespace pcavr {
namespace {

double block_size(const BuildOptions& options) {
  return kTsdfBlockVoxels * options.fusion.voxel_size;
}

bool is_weaker(const SurfaceEvidence& evidence, const BuildOptions& options) {
  return evidence.min_uncontradicted_weight < options.min_weight;
}

/// The frames by tile: which squares there are, and which frames see each.
class TileGrid {
 public:
  TileGrid(const TileFrames& frames, const CameraModel& camera, const BuildOptions& options)
      : frames_(frames.frames),
        block_(block_size(options)),
        side_(tile_blocks(frames.tile_size, options)),
        finder_(on_grid(camera, frames.width, frames.height), fusion_options(options)) {
    find_boxes();
  }

  [[nodiscard]] const std::vector<BlockBox>& boxes() const { return boxes_; }

  /// Whether each frame sees a tile, or the blocks next to it that its surface needs.
  [[nodiscard]] std::vector<bool> seeing(const BlockBox& tile) const {
    const BlockBox kept = tile.expanded(1);
    const Eigen::AlignedBox3d box(kept.low.cast<double>() * block_,
                                  kept.high.cast<double>() * block_);
    std::vector<bool> sees;
    for (const PlacedFrame& frame : frames_) sees.push_back(finder_.sees(frame.reach, box));
    return sees;
  }

 private:
  /// Squares of the grid from above that cover the reach of all frames, each over all heights.
  void find_boxes() {
    const double edge = side_ * block_;
    const auto cell = [](double x, double size) { return static_cast<int>(std::floor(x / size)); };
    // Of each frame alone: sites that are far apart have nothing between them.
    std::set<std::pair<int, int>> squares;  // y, x
    Eigen::AlignedBox3d all;
    for (const PlacedFrame& frame : frames_) {
      const Eigen::AlignedBox3d box = finder_.bounds(frame.reach);
      if (box.isEmpty()) continue;
      all.extend(box);
      for (int y = cell(box.min().y(), edge); y <= cell(box.max().y(), edge); ++y) {
        for (int x = cell(box.min().x(), edge); x <= cell(box.max().x(), edge); ++x) {
          squares.emplace(y, x);
        }
      }
    }
    if (squares.empty()) return;
    // One block more than the reach: the lowest one is not at the border of a tile.
    const int low = cell(all.min().z(), block_) - 1;
    const int high = cell(all.max().z(), block_) + 2;
    for (const auto& [y, x] : squares) {
      boxes_.push_back({{x * side_, y * side_, low}, {(x + 1) * side_, (y + 1) * side_, high}});
    }
  }

  const std::vector<PlacedFrame>& frames_;
  double block_;  ///< edge [m]
  int side_;      ///< of a tile [blocks]
  ReachFinder finder_;
  std::vector<BlockBox> boxes_;
};

/// An Error where an image is not of the size that it was surveyed with: the masks are.
std::optional<Error> check_size(const DepthImage& depth, const TileFrames& frames,
                                const Recording& recording, std::size_t index) {
  if (depth.width() == frames.width && depth.height() == frames.height) return std::nullopt;
  return Error{.message = fmt::format("has {} x {} pixels, and {} x {} when it was surveyed",
                                      depth.width(), depth.height(), frames.width, frames.height),
               .file = (recording.folder / recording.frames[index].depth_path).string(),
               .hint = "run survey again"};
}

Expected<void> fuse_frames(const TileFrames& frames, const std::vector<bool>& sees,
                           const Recording& recording, const BuildOptions& options,
                           SurfaceFusion& fusion) {
  using Decoded = Expected<std::optional<FusedFrame>>;
  std::size_t next = 0;
  const auto decode_next = [&]() -> Decoded {
    while (next < sees.size() && !sees[next]) ++next;
    if (next == sees.size()) return std::optional<FusedFrame>();
    const std::size_t index = frames.frames[next++].index;
    const Expected<RgbdFrame> frame = decode_frame(recording, index);
    if (!frame) return frame.error();
    if (auto other = check_size(frame->depth, frames, recording, index)) return *other;
    return std::optional(fused_frame(*frame, *recording.manifest.camera, options));
  };
  const auto is_last = [](const Decoded& item) { return !item || !*item; };
  Prefetcher prefetcher(decode_next, options.parallelism);
  for (std::size_t i = 0; i < sees.size(); ++i) {
    if (!sees[i]) {
      fusion.add_unseen();
      continue;
    }
    const Decoded frame = prefetcher.take(is_last);
    if (!frame) return frame.error();
    const PlacedFrame& placed = frames.frames[i];
    fusion.add(**frame, placed.is_dynamic.unpacked(), placed.T_base_camera);
  }
  return {};
}

/// Whether the triangles that a tile has without others' vertices are a surface that would not be
/// removed as an island, however they go on beyond it. Twice the area: rounding doesn't decide.
bool has_surface(const SurfaceTile& tile, double min_island) {
  TriangleMesh mesh;
  mesh.vertices = tile.mesh.vertices;
  for (const auto& triangle : tile.mesh.triangles) {
    const bool is_own = std::all_of(triangle.begin(), triangle.end(),
                                    [&](std::uint32_t v) { return v < mesh.vertices.size(); });
    if (is_own) mesh.triangles.push_back(triangle);
  }
  remove_small_components(mesh, 2.0 * min_island);
  return !mesh.triangles.empty();
}

TriangleMesh without_islands(std::vector<SurfaceTile> tiles, double min_island) {
  TriangleMesh mesh = joined(std::move(tiles));
  remove_small_components(mesh, min_island);
  return mesh;
}

template <typename Item>
void take(std::vector<Item>& from, std::vector<Item>& to) {
  to.insert(to.end(), from.begin(), from.end());
  std::vector<Item>().swap(from);
}

PointCloud take_points(std::vector<FusedTile>& tiles) {
  PointCloud all;
  std::size_t count = 0;
  for (const FusedTile& tile : tiles) count += tile.points.points.size();
  all.points.reserve(count);
  all.normals.reserve(count);
  all.colors.reserve(count);
  for (FusedTile& tile : tiles) {
    take(tile.points.points, all.points);
    take(tile.points.normals, all.normals);
    take(tile.points.colors, all.colors);
  }
  return all;
}

}  // namespace

int tile_blocks(double tile_size, const BuildOptions& options) {
  return std::max(1, static_cast<int>(std::lround(tile_size / block_size(options))));
}

std::string recording_digest(const Recording& recording) {
  Sha256 hash;
  hash.add_text(format_manifest(recording.manifest));
  for (const TimedPose& timed : recording.groundtruth.poses()) {
    const Eigen::Vector3d& p = timed.pose.translation();
    const Eigen::Quaterniond& q = timed.pose.rotation();
    hash.add(fmt::format("{} {} {} {} {} {} {} {}\n", timed.stamp.nanoseconds, p.x(), p.y(), p.z(),
                         q.x(), q.y(), q.z(), q.w()));
  }
  for (const FrameFiles& frame : recording.frames) {
    hash.add(fmt::format("{} {} {} {}\n", frame.color_stamp.nanoseconds,
                         frame.color_path.filename().string(), frame.depth_stamp.nanoseconds,
                         frame.depth_path.filename().string()));
  }
  for (const ObjectEntry& object : recording.manifest.objects) {
    if (object.mesh.empty()) continue;
    const Expected<std::string> mesh = read_file(recording.folder / object.mesh);
    hash.add_text(mesh ? *mesh : mesh.error().message);
  }
  return hash.digest();
}

TileFrameCollector::TileFrameCollector(double tile_size, const Recording& recording,
                                       const BuildOptions& options)
    : camera_(*recording.manifest.camera),
      options_(options),
      frames_{.recording = recording_digest(recording), .tile_size = tile_size} {}

void TileFrameCollector::add(const FollowedFrame& frame) {
  const DepthImage& depth = frame.frame.depth;
  if (!finder_) {
    frames_.width = depth.width();
    frames_.height = depth.height();
    finder_.emplace(on_grid(camera_, depth.width(), depth.height()), fusion_options(options_));
  }
  frames_.frames.push_back({.index = frame.frame.index,
                            .T_base_camera = frame.T_base_camera,
                            .objects = frame.objects,
                            .is_dynamic = PackedMask(frame.is_dynamic),
                            .reach = finder_->reach_of(depth, frame.T_base_camera)});
}

void FusedTiles::add(FusedTile tile) {
  if (!tile.strict) {
    for (FusedTile& before : tiles) before.strict.reset();
  }
  tiles.push_back(std::move(tile));
}

Expected<bool> fuse_part(const TileFrames& frames, const TilePart& part, const Recording& recording,
                         const BuildOptions& options, const Observer& observer,
                         const std::function<Expected<void>(FusedTile)>& use) {
  if (frames.frames.empty()) return false;
  const TileGrid grid(frames, *recording.manifest.camera, options);
  const SurfaceEvidence evidence = surface_evidence(options, frames.frames.size());
  bool has_agreed_surface = !is_weaker(evidence, options);
  const std::size_t count = grid.boxes().size();
  for (std::size_t i = part.number; i < count; i += part.count) {
    const BlockBox& tile = grid.boxes()[i];
    observer.on_progress("fusing tiles", i, count);
    const std::vector<bool> sees = grid.seeing(tile);
    if (std::find(sees.begin(), sees.end(), true) == sees.end()) continue;
    SurfaceFusion fusion(options, tile);
    const Expected<void> done = fuse_frames(frames, sees, recording, options, fusion);
    if (!done) return done.error();
    FusedTile one{.number = i,
                  .surface = fusion.volume.extract_tile(evidence, options.parallelism)};
    if (one.surface.mesh.vertices.empty() && one.surface.mesh.triangles.empty()) continue;
    if (!has_agreed_surface) {
      one.strict =
          fusion.volume.extract_tile({options.min_weight, options.min_weight}, options.parallelism);
      has_agreed_surface = has_surface(*one.strict, options.min_island);
      if (has_agreed_surface) one.strict.reset();
    }
    // With the points next to the tile, so that those at its border are no outliers.
    one.points =
        points_in(fusion.points_on(one.surface.mesh, evidence), tile, options.fusion.voxel_size);
    const Expected<void> used = use(std::move(one));
    if (!used) return used.error();
  }
  observer.on_progress("fusing tiles", count, count);
  return has_agreed_surface;
}

Expected<void> repeat_frames(const TileFrames& frames, const Recording& recording,
                             const BuildOptions& options, const Observer& observer,
                             const std::function<void(const FollowedFrame&)>& use) {
  using Decoded = Expected<std::optional<FollowedFrame>>;
  std::size_t next = 0;
  const auto decode_next = [&]() -> Decoded {
    if (next == frames.frames.size()) return std::optional<FollowedFrame>();
    const PlacedFrame& placed = frames.frames[next++];
    Expected<RgbdFrame> frame = decode_frame(recording, placed.index);
    if (!frame) return frame.error();
    if (auto other = check_size(frame->depth, frames, recording, placed.index)) return *other;
    return std::optional(FollowedFrame{.frame = *std::move(frame),
                                       .T_base_camera = placed.T_base_camera,
                                       .objects = placed.objects,
                                       .is_dynamic = placed.is_dynamic.unpacked()});
  };
  const auto is_last = [](const Decoded& item) { return !item || !*item; };
  Prefetcher prefetcher(decode_next, options.parallelism);
  while (true) {
    const Decoded frame = prefetcher.take(is_last);
    if (!frame) return frame.error();
    if (!*frame) return {};
    use(**frame);
    observer.on_progress("reading frames", (*frame)->frame.index + 1, recording.frames.size());
  }
}

std::pair<TriangleMesh, PointCloud> merge_tiles(FusedTiles fused, const BuildOptions& options) {
  std::sort(fused.tiles.begin(), fused.tiles.end(),
            [](const FusedTile& a, const FusedTile& b) { return a.number < b.number; });
  if (!fused.has_agreed_surface) {
    std::vector<SurfaceTile> strict;
    for (FusedTile& tile : fused.tiles) {
      if (tile.strict) strict.push_back(*std::exchange(tile.strict, std::nullopt));
    }
    TriangleMesh agreed = without_islands(std::move(strict), options.min_island);
    if (agreed.triangles.empty()) return {std::move(agreed), {}};
  }
  PointCloud points = take_points(fused.tiles);
  std::vector<SurfaceTile> tiles;
  for (FusedTile& tile : fused.tiles) tiles.push_back(std::move(tile.surface));
  return {without_islands(std::move(tiles), options.min_island), std::move(points)};
}

}  // namespace pcavr
