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
/// Area of a surface in each cube that it meets, of the cube's face: a plane of any direction meets
/// 1.5 for each face on average.
constexpr double kFaces = 1.0 / 1.5;
/// Frames that are looked at: first few, each as if it saw a surface of its own, which is enough
/// where that fits; else more, together.
constexpr std::size_t kFirstFrames = 16;
constexpr std::size_t kMaxAreaFrames = 240;

/// From the sizes of what is kept, not measured (docs/scale.md) [bytes]: what does not depend on
/// the surface, and what each square of a voxel's face takes, in all and where tiles are fused one
/// after the other.
constexpr double kConstant = 0.35e9;
constexpr double kEachFace = 330.0;
constexpr double kEachFaceByTiles = 90.0;

using Cubes = std::unordered_set<std::uint64_t>;

std::uint64_t cube_key(const Eigen::Vector3d& p) {
  const auto bits = [](double x) {
    return static_cast<std::uint64_t>(std::llround(std::floor(x / kCube))) & 0x1FFFFFU;
  };
  return bits(p.x()) << 42 | bits(p.y()) << 21 | bits(p.z());
}

/// Adds the cubes in which a frame measured something.
void add_cubes(const DepthImage& depth, const CameraModel& color_camera, const Pose& T_base_camera,
               const DepthNoise& noise, Cubes& cubes) {
  const CameraModel camera = on_grid(color_camera, depth.width(), depth.height());
  // Twice as dense as the cubes at 5 m.
  const int stride = std::clamp(static_cast<int>(camera.fx * kCube / 10.0), 1, 16);
  for (int v = 0; v < camera.height; v += stride) {
    for (int u = 0; u < camera.width; u += stride) {
      const double z = double{depth(u, v)};
      if (z < noise.min_depth || z > noise.max_depth) continue;
      const Eigen::Vector3d p = T_base_camera * camera.unproject(Eigen::Vector2d(u, v), z);
      if (p.cwiseAbs().maxCoeff() < ranges::kCoordinate.max) cubes.insert(cube_key(p));
    }
  }
}

double area_of(std::size_t cubes) { return kFaces * kCube * kCube * static_cast<double>(cubes); }

/// 0.0234 -> 0.024, so that a suggested voxel has two digits.
double rounded_up(double voxel) { return std::ceil(voxel * 1e3 - 1e-9) * 1e-3; }

/// Peak memory of a build of so much surface [bytes].
double memory_need(double area, double voxel_size, bool by_tiles) {
  const double faces = area / (voxel_size * voxel_size);
  return kConstant + (by_tiles ? kEachFaceByTiles : kEachFace) * faces;
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

  /// By a few frames, each as if it saw a surface of its own [m^2]: an upper bound.
  [[nodiscard]] double apart() const {
    const std::size_t frames = std::min(kFirstFrames, placed_.size());
    if (frames == 0) return 0.0;
    return area_of(count(frames, false)) * static_cast<double>(placed_.size()) /
           static_cast<double>(frames);
  }
  /// By many frames [m^2].
  [[nodiscard]] double together() const {
    return area_of(count(std::min(kMaxAreaFrames, placed_.size()), true));
  }

 private:
  [[nodiscard]] std::size_t count(std::size_t frames, bool together) const {
    std::size_t sum = 0;
    Cubes cubes;
    for (std::size_t i = 0; i < frames; ++i) {
      const std::size_t index = placed_[i * placed_.size() / frames];
      const Expected<RgbdFrame> frame = decode_frame(recording_, index);
      if (!frame) continue;  // the first pass names it
      if (!together) cubes.clear();
      add_cubes(frame->depth, *recording_.manifest.camera, *poses_[index], noise_, cubes);
      sum = together ? cubes.size() : sum + cubes.size();
    }
    return sum;
  }

  const Recording& recording_;
  const std::vector<std::optional<Pose>>& poses_;
  const DepthNoise& noise_;
  std::vector<std::size_t> placed_;
};

/// What fits in place of what does not.
std::string smaller(double area, double need, double voxel, const BuildLimits& limits) {
  std::vector<std::string> choices;
  const double room = std::max(limits.max_memory - kConstant, 1.0);
  const double fitting = rounded_up(voxel * std::sqrt((need - kConstant) / room));
  if (fitting <= ranges::kVoxel.max) choices.push_back(fmt::format("--voxel {:g}", fitting));
  if (!limits.tile_size && memory_need(area, voxel, true) <= limits.max_memory) {
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
  const auto need_of = [&](double area) {
    return memory_need(area, voxel, limits.tile_size.has_value());
  };
  if (need_of(seen.apart()) <= limits.max_memory) return {};
  const double area = seen.together();
  const double need = need_of(area);
  if (need <= limits.max_memory) return {};
  return Error{
      .message = fmt::format("needs {:.1f} GB at {:g} mm for some {:.0f} m^2 of surface, more than "
                             "the {:.1f} GB that it may take",
                             1e-9 * need, 1e3 * voxel, area, 1e-9 * limits.max_memory),
      .file = recording.folder.string(),
      .hint = smaller(area, need, voxel, limits)};
}

}  // namespace pcavr
