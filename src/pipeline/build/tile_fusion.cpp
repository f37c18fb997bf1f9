// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tile_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/freed_memory.hpp"
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
  using Squares = std::set<std::pair<int, int>>;  ///< y, x

  /// Squares of the grid from above that cover the reach of all frames, each over all heights. The
  /// grid is where the fewest do: a frame is fused for each that it sees.
  void find_boxes() {
    constexpr int kShifts = 8;  // of the grid, along each axis
    std::vector<Eigen::AlignedBox3d> reaches;
    Eigen::AlignedBox3d all;
    for (const PlacedFrame& frame : frames_) {
      const Eigen::AlignedBox3d box = finder_.bounds(frame.reach);
      if (box.isEmpty()) continue;
      all.extend(box);
      reaches.push_back(box);
    }
    if (reaches.empty()) return;
    Squares squares;
    Eigen::Vector2i shift = Eigen::Vector2i::Zero();  // [blocks]
    for (int i = 0; i < kShifts * kShifts; ++i) {
      const Eigen::Vector2i tried = Eigen::Vector2i(i % kShifts, i / kShifts) * side_ / kShifts;
      Squares met = squares_of(reaches, tried);
      if (!squares.empty() && met.size() >= squares.size()) continue;
      squares = std::move(met);
      shift = tried;
    }
    // One block more than the reach: the lowest one is not at the border of a tile.
    const int low = static_cast<int>(std::floor(all.min().z() / block_)) - 1;
    const int high = static_cast<int>(std::floor(all.max().z() / block_)) + 2;
    for (const auto& [y, x] : squares) {
      const int left = x * side_ + shift.x(), front = y * side_ + shift.y();
      boxes_.push_back({{left, front, low}, {left + side_, front + side_, high}});
    }
  }

  /// Those that the boxes meet, of each alone: sites that are far apart have nothing between them.
  [[nodiscard]] Squares squares_of(const std::vector<Eigen::AlignedBox3d>& boxes,
                                   const Eigen::Vector2i& shift) const {
    const auto column = [&](const Eigen::Vector3d& p, int axis) {
      return static_cast<int>(std::floor((p[axis] / block_ - shift[axis]) / side_));
    };
    Squares squares;
    for (const Eigen::AlignedBox3d& box : boxes) {
      for (int y = column(box.min(), 1); y <= column(box.max(), 1); ++y) {
        for (int x = column(box.min(), 0); x <= column(box.max(), 0); ++x) squares.emplace(y, x);
      }
    }
    return squares;
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

/// The surface of a volume, which is freed: its blocks take more than what comes after.
void extract(TsdfPart volume, const SurfaceEvidence& evidence, const BuildOptions& options,
             FusedTile& tile, bool& has_agreed_surface) {
  tile.surface = volume.extract_tile(evidence, options.parallelism);
  if (has_agreed_surface) return;
  tile.strict = volume.extract_tile({options.min_weight, options.min_weight}, options.parallelism);
  has_agreed_surface = has_surface(*tile.strict, options.min_island);
  if (has_agreed_surface) tile.strict.reset();
}

/// Tiles stay until all are fused, with what their arrays were grown to.
void shrink(FusedTile& tile) {
  const auto shrink_all = [](auto&... arrays) { (arrays.shrink_to_fit(), ...); };
  TriangleMesh& mesh = tile.surface.mesh;
  shrink_all(mesh.vertices, mesh.normals, mesh.colors, mesh.triangles, tile.surface.lent,
             tile.surface.borrowed, tile.points.points, tile.points.normals, tile.points.colors);
}

TriangleMesh without_islands(std::vector<SurfaceTile> tiles, double min_island) {
  TriangleMesh mesh = joined(std::move(tiles));
  remove_small_components(mesh, min_island);
  return mesh;
}

/// By tile: to be filtered one after the other, as all of them twice would be the peak of a build.
std::vector<PointCloud> take_points(std::vector<FusedTile>& tiles) {
  std::vector<PointCloud> points;
  for (FusedTile& tile : tiles) points.push_back(std::exchange(tile.points, {}));
  return points;
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
    return_freed_memory();  // of the tile before
    SurfaceFusion fusion(options, tile);
    const Expected<void> done = fuse_frames(frames, sees, recording, options, fusion);
    if (!done) return done.error();
    FusedTile one{.number = i};
    extract(std::move(fusion.volume), evidence, options, one, has_agreed_surface);
    if (one.surface.mesh.vertices.empty() && one.surface.mesh.triangles.empty()) continue;
    // With the points next to the tile, so that those at its border are no outliers.
    one.points =
        points_in(fusion.points_on(one.surface.mesh, evidence), tile, options.fusion.voxel_size);
    shrink(one);
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

std::pair<TriangleMesh, std::vector<PointCloud>> merge_tiles(FusedTiles fused,
                                                             const BuildOptions& options) {
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
  std::vector<PointCloud> points = take_points(fused.tiles);
  std::vector<SurfaceTile> tiles;
  for (FusedTile& tile : fused.tiles) tiles.push_back(std::move(tile.surface));
  return {without_islands(std::move(tiles), options.min_island), std::move(points)};
}

}  // namespace pcavr
