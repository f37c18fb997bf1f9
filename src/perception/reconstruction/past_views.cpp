// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/past_views.hpp"

#include <algorithm>
#include <span>

namespace pcavr {
namespace {

constexpr float kDepthUnit = 0.00025F;  // [m]; 16 bits cover 16 m

}  // namespace

bool PastViews::is_next_sampled() {
  if (frames_++ % stride_ != 0) return false;
  if (views_.size() == kMaxViews) {
    for (std::size_t i = 1; 2 * i < views_.size(); ++i) views_[i] = std::move(views_[2 * i]);
    views_.resize(kMaxViews / 2);
    stride_ *= 2;
    // The current frame is a multiple of the doubled stride, as kMaxViews is even.
  }
  return true;
}

void PastViews::add_unseen() {
  if (is_next_sampled()) views_.emplace_back();
}

void PastViews::add(const FrameSurface& frame, const Pose& T_base_camera) {
  if (!is_next_sampled()) return;
  const Pose T_camera_base = T_base_camera.inverse();
  View view{T_camera_base.rotation_matrix().cast<float>(),
            T_camera_base.translation().cast<float>(),
            static_cast<float>(frame.camera.fx),
            static_cast<float>(frame.camera.fy),
            static_cast<float>(frame.camera.cx + 0.5),
            static_cast<float>(frame.camera.cy + 0.5),
            frame.free_depth.width(),
            frame.free_depth.height(),
            0.0F,
            {}};
  const std::span<const float> free_depth = frame.free_depth.pixels();
  view.free_depth.resize(free_depth.size());
  for (std::size_t i = 0; i < free_depth.size(); ++i) {
    const auto units = static_cast<int>(std::min(free_depth[i] / kDepthUnit, 65535.0F));
    view.free_depth[i] = static_cast<std::uint16_t>(units);
  }
  for (const DepthTile& tile : frame.tiles) {
    view.max_free_depth = std::max(view.max_free_depth, tile.max_free);
  }
  views_.push_back(std::move(view));
}

void PastViews::count_free_views(const BlockCoordinates& coordinates, double voxel_size,
                                 VoxelBlock& block) const {
  const auto voxel = static_cast<float>(voxel_size);
  const Eigen::Vector3f p_base =
      Eigen::Vector3d(coordinates.x, coordinates.y, coordinates.z).cast<float>() *
      (kBlockSide * voxel);
  for (const View& view : views_) {
    if (view.max_free_depth > 0.0F) count_free_views(view, p_base, voxel, block);
  }
}

void PastViews::count_free_views(const View& view, const Eigen::Vector3f& p_base, float voxel_size,
                                 VoxelBlock& block) {
  // Frustum culling: the block's bounding sphere against the image's borders and the maximum free
  // depth.
  const float half = 0.5F * (kBlockSide - 1) * voxel_size;
  const float radius = 1.7321F * half;
  const Eigen::Vector3f centre =
      view.R_camera_base * (p_base + Eigen::Vector3f::Constant(half)) + view.p_camera_base;
  if (centre.z() - radius > view.max_free_depth || centre.z() + radius <= 0.0F) return;
  const float reach = std::max(centre.z() + radius, 0.0F);
  const auto is_outside = [&](float c, float f, float low, float high) {
    return f * (c + radius) < low * reach || f * (c - radius) > high * reach;
  };
  if (is_outside(centre.x(), view.fx, std::min(-view.cx, 0.0F),
                 std::max(static_cast<float>(view.width) - view.cx, 0.0F)) ||
      is_outside(centre.y(), view.fy, std::min(-view.cy, 0.0F),
                 std::max(static_cast<float>(view.height) - view.cy, 0.0F))) {
    return;
  }
  const Eigen::Matrix3f steps = view.R_camera_base * voxel_size;
  const Eigen::Vector3f first = view.R_camera_base * p_base + view.p_camera_base;
  for (std::size_t i = 0; i < kBlockVoxels; ++i) {
    const Eigen::Vector3f at(static_cast<float>(i % 8), static_cast<float>(i / 8 % 8),
                             static_cast<float>(i / 64));
    const Eigen::Vector3f p = first + steps * at;
    if (p.z() <= 0.0F || p.z() > view.max_free_depth) continue;
    const float u = view.fx * p.x() / p.z() + view.cx;
    const float v = view.fy * p.y() / p.z() + view.cy;
    if (u < 0.0F || v < 0.0F || u >= static_cast<float>(view.width) ||
        v >= static_cast<float>(view.height)) {
      continue;
    }
    const auto pixel =
        static_cast<std::size_t>(static_cast<int>(v) * view.width + static_cast<int>(u));
    const bool is_free = p.z() < static_cast<float>(view.free_depth[pixel]) * kDepthUnit;
    std::uint32_t& counts = block.color_counts[i];
    if (is_free && free_count(counts) < kMaxCount) counts += 1U << 28;
  }
}

std::size_t PastViews::memory_bytes() const {
  std::size_t bytes = 0;
  for (const View& view : views_) {
    bytes += sizeof(View) + view.free_depth.capacity() * sizeof(std::uint16_t);
  }
  return bytes;
}

}  // namespace pcavr
