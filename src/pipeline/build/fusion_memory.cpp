// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "fusion_memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <unordered_set>
#include <vector>

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

namespace pcavr {
namespace {

constexpr double kBlockVoxels = 8.0;  // edge of the blocks that fusion keeps
/// Of a block that shows surface: fusion's band of blocks, the cloud's voxels, mesh and levels of
/// detail. Measured as peak memory over such blocks, see docs/files.md.
constexpr double kBytesPerBlock = 28e3;
constexpr std::size_t kSampledFrames = 32;
constexpr double kGigabyte = 1e9;

/// Pixels between rays that are not farther apart than `edge` [m], where the depth ends.
int ray_step(const CameraModel& camera, double edge, double max_depth) {
  return std::clamp(static_cast<int>(edge * camera.fx / max_depth), 1, 8);
}

/// The blocks of surface that some frames show.
class SurfaceBlocks {
 public:
  SurfaceBlocks(double voxel_size, double max_depth)
      : edge_(kBlockVoxels * voxel_size), max_depth_(max_depth) {}

  void add(const DepthImage& depth, const CameraModel& camera, const Pose& T_base_camera) {
    const int step = ray_step(camera, edge_, max_depth_);
    for (int v = 0; v < depth.height(); v += step) {
      for (int u = 0; u < depth.width(); u += step) {
        const double z = depth(u, v);
        if (!(z > 0.0) || z > max_depth_) continue;
        const Eigen::Vector3d p_camera(z * (u - camera.cx) / camera.fx,
                                       z * (v - camera.cy) / camera.fy, z);
        keys_.insert(key_of(T_base_camera * p_camera));
      }
    }
  }
  [[nodiscard]] double count() const { return static_cast<double>(keys_.size()); }

 private:
  /// 21 bits for each coordinate.
  [[nodiscard]] std::uint64_t key_of(const Eigen::Vector3d& p_base) const {
    std::uint64_t key = 0;
    for (int i = 0; i < 3; ++i) {
      const auto cell = static_cast<std::int64_t>(std::floor(p_base[i] / edge_));
      key = (key << 21U) | (static_cast<std::uint64_t>(cell) & 0x1FFFFFU);
    }
    return key;
  }

  double edge_;
  double max_depth_;
  std::unordered_set<std::uint64_t> keys_ = {};
};

double bytes_of_frames(const Recording& recording, const std::vector<FramePlacement>& frames,
                       double voxel_size, double max_depth) {
  SurfaceBlocks blocks(voxel_size, max_depth);
  for (const FramePlacement& placed : frames) {
    const Expected<RgbdFrame> frame = decode_frame(recording, placed.frame);
    if (!frame) continue;  // fusion reports or leaves it out
    const CameraModel camera =
        on_grid(*recording.manifest.camera, frame->depth.width(), frame->depth.height());
    blocks.add(frame->depth, camera, placed.T_base_camera);
  }
  return kBytesPerBlock * blocks.count();
}

/// A line of /proc/meminfo [bytes].
std::optional<double> available_of_machine() {
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("MemAvailable:")) continue;
    std::istringstream words(line.substr(line.find(':') + 1));
    double kilobytes = 0.0;
    if (words >> kilobytes) return 1024.0 * kilobytes;
  }
  return std::nullopt;
}

std::optional<double> left_of_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  std::ifstream file("/proc/self/statm");
  double pages = 0.0;
  if (!(file >> pages)) return std::nullopt;
  return static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

std::optional<double> available_memory() {
  const std::optional<double> machine = available_of_machine();
  const std::optional<double> own = left_of_limit();
  if (machine && own) return std::min(*machine, *own);
  return machine ? machine : own;
}

double estimate_fusion_memory(const Recording& recording, const CameraTrack& camera,
                              double voxel_size, double max_depth, double limit) {
  std::vector<FramePlacement> placed;
  for (const FramePlacement& frame : camera.frames) {
    if (frame.status == PlacementStatus::placed) placed.push_back(frame);
  }
  if (placed.empty()) return 0.0;
  const CameraModel& color = *recording.manifest.camera;
  const double rays = static_cast<double>(color.width) * static_cast<double>(color.height) /
                      std::pow(ray_step(color, kBlockVoxels * voxel_size, max_depth), 2);
  const double most_of_any = kBytesPerBlock * rays * static_cast<double>(placed.size());
  if (most_of_any <= limit) return most_of_any;
  if (placed.size() > kSampledFrames) {
    std::vector<FramePlacement> some;
    for (std::size_t i = 0; i < kSampledFrames; ++i)
      some.push_back(placed[i * placed.size() / kSampledFrames]);
    const double scale = static_cast<double>(placed.size()) / static_cast<double>(some.size());
    const double most = scale * bytes_of_frames(recording, some, voxel_size, max_depth);
    if (most <= limit) return most;
  }
  return bytes_of_frames(recording, placed, voxel_size, max_depth);
}

std::optional<Error> too_little_memory(const Recording& recording, const CameraTrack& camera,
                                       double voxel_size, double max_depth) {
  const std::optional<double> available = available_memory();
  if (!available) return std::nullopt;
  const double needed =
      estimate_fusion_memory(recording, camera, voxel_size, max_depth, *available);
  if (needed <= *available) return std::nullopt;
  // The surface's blocks go by the square of their size.
  const double enough = voxel_size * std::sqrt(needed / std::max(*available, 1.0));
  return Error{.message = fmt::format(
                   "its scene needs some {:.1f} GB of memory at a voxel of {:.0f} mm, and "
                   "{:.1f} GB are available",
                   needed / kGigabyte, 1e3 * voxel_size, std::max(*available, 0.0) / kGigabyte),
               .file = recording.folder.string(),
               .place = {},
               .hint = fmt::format("--voxel {:.3f}, or a part of the recording",
                                   std::ceil(1e3 * enough) / 1e3)};
}

}  // namespace pcavr
