// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "memory_need.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <unordered_set>

#include <fmt/format.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

namespace pcavr {
namespace {

/// Edge of the cubes that are counted [m]: some readings of a far surface fall into each.
constexpr double kCube = 0.08;
/// Edge of the cubes of free space that are counted [m], and the step along a ray.
constexpr double kSpaceCube = 0.25;
constexpr double kSpaceStep = 0.2;
/// Area of a surface in each cube that it meets, of the cube's face: a plane of any direction meets
/// 1.5 for each face on average.
constexpr double kFaces = 1.0 / 1.5;
/// Frames that are looked at: first few, each as if it saw a surface of its own, which is enough
/// where that fits; else more, together.
constexpr int kSpaceStride = 4;  ///< of the readings, whose rays are followed
constexpr std::size_t kFirstFrames = 16;
constexpr std::size_t kMaxAreaFrames = 240;

/// From the sizes of what is kept and two scenes (docs/scale.md) [bytes]: what does not depend on
/// the scene; what each square of a voxel's face takes, and as long as its tile is fused; what each
/// cell of the occupancy map takes.
constexpr double kConstant = 0.35e9;
constexpr double kEachFace = 90.0;
constexpr double kEachFusedFace = 240.0;
constexpr double kEachCell = 49.0;

using Cubes = std::unordered_set<std::uint64_t>;

std::uint64_t cube_key(const Eigen::Vector3d& p, double edge) {
  const auto bits = [edge](double x) {
    return static_cast<std::uint64_t>(std::llround(std::floor(x / edge))) & 0x1FFFFFU;
  };
  return bits(p.x()) << 42 | bits(p.y()) << 21 | bits(p.z());
}

/// Cubes of surface and of the space before it.
struct SeenCubes {
  Cubes surface = {}, space = {};
};
/// How many of each.
struct Counts {
  std::size_t surface = 0, space = 0;
};

/// Adds the cubes in which a frame measured something, and through which it looked.
void add_cubes(const DepthImage& depth, const CameraModel& color_camera, const Pose& T_base_camera,
               const DepthNoise& noise, SeenCubes& cubes) {
  const CameraModel camera = on_grid(color_camera, depth.width(), depth.height());
  // Twice as dense as the cubes at 5 m.
  const int stride = std::clamp(static_cast<int>(camera.fx * kCube / 10.0), 1, 16);
  for (int v = 0; v < camera.height; v += stride) {
    for (int u = 0; u < camera.width; u += stride) {
      const double z = double{depth(u, v)};
      if (z < noise.min_depth || z > noise.max_depth) continue;
      const Eigen::Vector3d p = T_base_camera * camera.unproject(Eigen::Vector2d(u, v), z);
      if (!(p.cwiseAbs().maxCoeff() < ranges::kCoordinate.max)) continue;
      cubes.surface.insert(cube_key(p, kCube));
      if (u % (kSpaceStride * stride) != 0 || v % (kSpaceStride * stride) != 0) continue;
      const Eigen::Vector3d from = T_base_camera.translation(), ray = p - from;
      const double length = ray.norm();
      for (double at = 0.0; at < length; at += kSpaceStep) {
        cubes.space.insert(cube_key(from + at / length * ray, kSpaceCube));
      }
    }
  }
}

/// What frames saw.
struct SeenScene {
  double area = 0.0;    ///< [m^2] of surface
  double volume = 0.0;  ///< [m^3] of free space
};

SeenScene scene_of(const Counts& counts, double times = 1.0) {
  return {times * kFaces * kCube * kCube * static_cast<double>(counts.surface),
          times * std::pow(kSpaceCube, 3) * static_cast<double>(counts.space)};
}

/// 0.0234 -> 0.024, so that a suggested voxel has two digits.
double rounded_up(double voxel) { return std::ceil(voxel * 1e3 - 1e-9) * 1e-3; }

/// Peak memory [bytes] of a build. A tile has a floor, a ceiling and some walls: three times its
/// square.
double memory_need(const SeenScene& scene, double voxel_size, const std::optional<double>& tile,
                   double cell) {
  const double fused = tile ? std::min(scene.area, 3.0 * *tile * *tile) : scene.area;
  return kConstant + kEachCell * scene.volume / std::pow(cell, 3) +
         (kEachFace * scene.area + kEachFusedFace * fused) / (voxel_size * voxel_size);
}

/// Looks at frames of a recording whose poses are known.
class AreaCount {
 public:
  AreaCount(const Recording& recording, const std::vector<std::optional<Pose>>& poses,
            const DepthNoise& noise)
      : recording_(recording), poses_(poses), noise_(noise) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (poses[i]) placed_.push_back(i);
    }
  }

  /// By a few frames, each as if it saw what no other does: an upper bound.
  [[nodiscard]] SeenScene apart() const {
    const std::size_t frames = std::min(kFirstFrames, placed_.size());
    if (frames == 0) return {};
    return scene_of(count(frames, false),
                    static_cast<double>(placed_.size()) / static_cast<double>(frames));
  }
  /// By many frames.
  [[nodiscard]] SeenScene together() const {
    return scene_of(count(std::min(kMaxAreaFrames, placed_.size()), true));
  }

 private:
  [[nodiscard]] Counts count(std::size_t frames, bool together) const {
    Counts sum;
    SeenCubes cubes;
    for (std::size_t i = 0; i < frames; ++i) {
      const std::size_t index = placed_[i * placed_.size() / frames];
      const Expected<RgbdFrame> frame = decode_frame(recording_, index);
      if (!frame) continue;  // the first pass names it
      if (!together) cubes = {};
      add_cubes(frame->depth, *recording_.manifest.camera, *poses_[index], noise_, cubes);
      if (together) sum = {};
      sum.surface += cubes.surface.size();
      sum.space += cubes.space.size();
    }
    return sum;
  }

  const Recording& recording_;
  const std::vector<std::optional<Pose>>& poses_;
  const DepthNoise& noise_;
  std::vector<std::size_t> placed_;
};

/// What fits in place of what does not.
std::string smaller(const SeenScene& scene, double voxel, double cell, const BuildLimits& limits) {
  const double fixed = memory_need({0.0, scene.volume}, voxel, {}, cell);
  const double rest = limits.max_memory - fixed;
  if (rest <= 0.0) {
    const double room = std::max(limits.max_memory - kConstant, 1.0);
    return fmt::format(
        "set scene.occupancy.resolution to {:g} m or more: free space alone does not fit",
        rounded_up(cell * std::cbrt(2.0 * (fixed - kConstant) / room)));
  }
  std::vector<std::string> choices;
  const double need = memory_need(scene, voxel, limits.tile_size, cell);
  const double fitting = rounded_up(voxel * std::sqrt((need - fixed) / rest));
  if (fitting <= ranges::kVoxel.max) choices.push_back(fmt::format("--voxel {:g}", fitting));
  if (!limits.tile_size && memory_need(scene, voxel, kDefaultTile, cell) <= limits.max_memory) {
    choices.push_back(fmt::format("--tiles {:g}", kDefaultTile));
  }
  if (choices.empty()) return "no voxel fits; --max-memory sets the limit";
  return fmt::format("give {}; --max-memory sets the limit", fmt::join(choices, " or "));
}

}  // namespace

std::vector<std::optional<Pose>> stated_poses(const Recording& recording) {
  std::vector<std::optional<Pose>> poses;
  for (const FrameFiles& frame : recording.frames) {
    poses.push_back(recording.groundtruth.at(frame.depth_stamp));
  }
  return poses;
}

Expected<void> check_memory(const BuildLimits& limits, const Recording& recording,
                            const std::vector<std::optional<Pose>>& poses,
                            const BuildOptions& options) {
  if (limits.max_memory <= 0.0) return {};
  const AreaCount seen(recording, poses, options.perception.depth_noise);
  const double voxel = options.fusion.voxel_size;
  const double cell = options.occupancy.resolution;
  const auto need_of = [&](const SeenScene& scene) {
    return memory_need(scene, voxel, limits.tile_size, cell);
  };
  if (need_of(seen.apart()) <= limits.max_memory) return {};
  const SeenScene scene = seen.together();
  const double need = need_of(scene);
  if (need <= limits.max_memory) return {};
  return Error{.message = fmt::format(
                   "needs {:.1f} GB at {:g} mm for some {:.0f} m^2 of surface and {:.0f} "
                   "m^3 before it, more than the {:.1f} GB that it may take",
                   1e-9 * need, 1e3 * voxel, scene.area, scene.volume, 1e-9 * limits.max_memory),
               .file = recording.folder.string(),
               .hint = smaller(scene, voxel, cell, limits)};
}

}  // namespace pcavr
