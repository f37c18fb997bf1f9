// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tool_mask.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/geometry/pixel.hpp"

namespace pcavr {
namespace {

/// Stride of the pixels that are stored in each direction: the cells are not finer.
constexpr int kStride = 3;

struct Disc {
  Eigen::Vector2d centre;
  double radius = 0.0;  ///< [px]
};

struct PixelBox {
  int left = 0, right = -1, top = 0, bottom = -1;
};

PixelBox around(const Disc& disc, const CameraModel& camera) {
  return {clamp_to_int(std::floor(disc.centre.x() - disc.radius), 0, camera.width),
          clamp_to_int(std::ceil(disc.centre.x() + disc.radius), -1, camera.width - 1),
          clamp_to_int(std::floor(disc.centre.y() - disc.radius), 0, camera.height),
          clamp_to_int(std::ceil(disc.centre.y() + disc.radius), -1, camera.height - 1)};
}

/// Calls `visit` for the pixels of a disc that lie in the image.
template <typename Visit>
void for_disc(const Disc& disc, const CameraModel& camera, const Visit& visit) {
  const PixelBox box = around(disc, camera);
  for (int y = box.top; y <= box.bottom; ++y) {
    for (int x = box.left; x <= box.right; ++x) {
      if ((Eigen::Vector2d(x, y) - disc.centre).norm() <= disc.radius) visit(x, y);
    }
  }
}

using Pixel = std::pair<int, int>;

/// Region growing: the pixels that are connected with the seeds in `region` by continuous depth and
/// lie above `min_height` in base, including the seeds.
std::vector<Pixel> grow(std::vector<Pixel> region, const RgbdFrame& frame,
                        const CameraModel& camera, const Pose& T_base_camera, double min_height,
                        double max_depth_step_in) {
  const auto max_depth_step = static_cast<float>(max_depth_step_in);
  const DepthImage& depth = frame.depth;
  const Eigen::Vector3d up_camera = T_base_camera.inverse().rotation() * Eigen::Vector3d::UnitZ();
  const double height_of_camera = T_base_camera.translation().z();
  MaskImage is_known(depth.width(), depth.height());
  for (const auto& [x, y] : region) is_known(x, y) = 1;
  constexpr std::array<Pixel, 4> kNeighbours = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (std::size_t next = 0; next < region.size(); ++next) {
    const auto [x, y] = region[next];
    for (const auto& [dx, dy] : kNeighbours) {
      const int u = x + dx;
      const int v = y + dy;
      if (!depth.contains(u, v) || is_known(u, v) != 0 || depth(u, v) <= 0.0F) continue;
      if (std::abs(depth(u, v) - depth(x, y)) > max_depth_step) continue;
      const Eigen::Vector3d p_camera = camera.unproject(Eigen::Vector2d(u, v), depth(u, v));
      if (height_of_camera + up_camera.dot(p_camera) < min_height) continue;
      is_known(u, v) = 1;
      region.emplace_back(u, v);
    }
  }
  return region;
}

/// Unmasked pixels whose depth agrees with the tool's stored shape.
std::vector<Pixel> seeds_of(const ToolShape& shape, const RgbdFrame& frame,
                            const CameraModel& camera, const Pose& T_camera_tool,
                            const MaskImage& mask) {
  std::vector<Pixel> seeds;
  for (const Eigen::Vector3d& p_tool : shape.points()) {
    const Eigen::Vector3d p_camera = T_camera_tool * p_tool;
    if (p_camera.z() <= ToolShape::kEdge) continue;
    const Eigen::Vector2d pixel = camera.project(p_camera);
    const std::optional<int> x = pixel_index(pixel.x(), frame.depth.width());
    const std::optional<int> y = pixel_index(pixel.y(), frame.depth.height());
    if (!x || !y || mask(*x, *y) != 0 || frame.depth(*x, *y) <= 0.0F) continue;
    if (std::abs(frame.depth(*x, *y) - p_camera.z()) <= ToolShape::kEdge) {
      seeds.emplace_back(*x, *y);
    }
  }
  return seeds;
}

}  // namespace

void ToolMask::mark(const RgbdFrame& frame, const Pose& T_base_camera, MaskImage& mask) {
  if (!recording_.manifest.tool_radius || recording_.tool.empty()) return;
  const Duration max_gap(std::llround(options_.max_tool_gap * 1e9));
  const std::optional<Pose> T_base_tool = recording_.tool.at(frame.depth_stamp, max_gap);
  if (!T_base_tool) return;
  const CameraModel camera =
      on_grid(*recording_.manifest.camera, frame.depth.width(), frame.depth.height());
  const Pose T_camera_tool = T_base_camera.inverse() * *T_base_tool;
  const Eigen::Vector3d& p_camera = T_camera_tool.translation();
  const double reach = *recording_.manifest.tool_radius + options_.tip_margin;
  if (p_camera.z() <= reach) return;
  const Disc disc{camera.project(p_camera), camera.fx * reach / p_camera.z()};

  std::vector<Pixel> seeds;
  const double min_height = T_base_tool->translation().z();
  for_disc(disc, camera, [&](int x, int y) {
    const float z = frame.depth(x, y);
    // Pixels of the body that the tip touches are masked already, and are not seeds.
    if (mask(x, y) == 0 && z > 0.0F && std::abs(z - p_camera.z()) <= reach &&
        (T_base_camera * camera.unproject(Eigen::Vector2d(x, y), z)).z() >= min_height) {
      seeds.emplace_back(x, y);
    }
  });
  const bool is_tip_seen = !seeds.empty();
  for (const Pixel& seed : seeds_of(shape_, frame, camera, T_camera_tool, mask)) {
    seeds.push_back(seed);
  }
  for_disc(disc, camera, [&](int x, int y) { mask(x, y) = 1; });
  const double dilation = options_.tool_margin;
  for (const auto& [x, y] :
       grow(std::move(seeds), frame, camera, T_base_camera, min_height, options_.max_depth_step)) {
    for_disc({Eigen::Vector2d(x, y), dilation}, camera, [&](int u, int v) { mask(u, v) = 1; });
    if (!is_tip_seen || x % kStride != 0 || y % kStride != 0) continue;
    const Eigen::Vector3d p = camera.unproject(Eigen::Vector2d(x, y), frame.depth(x, y));
    shape_.add(T_camera_tool.inverse() * p, T_base_tool->translation());
  }
}

}  // namespace pcavr
