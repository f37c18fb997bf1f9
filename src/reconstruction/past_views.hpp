// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/pose.hpp"

#include "reconstruction/frame_surface.hpp"
#include "reconstruction/voxel_block.hpp"

namespace pcavr {

/// What frames saw through before a block was there. Without it, something that comes to rest where
/// earlier frames saw nothing would stay: blocks count only from the frame that adds them. Kept
/// evenly over time, at most kMaxViews, so that memory does not grow with the recording.
class PastViews {
 public:
  static constexpr std::size_t kMaxViews = 64;  ///< 10 MB at 640 x 480

  /// Remembers the frame if it is its turn.
  void keep(const FrameSurface& frame, const Pose& T_base_camera);

  /// Adds to each voxel's count how many of the views saw through it.
  void count_through(const BlockPlace& place, double voxel_size, VoxelBlock& block) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct View {
    Eigen::Matrix3f R_camera_base;
    Eigen::Vector3f p_camera_base;
    float fx, fy, cx, cy;  ///< with the half pixel for rounding
    int width, height;
    float farthest;                         ///< of all free depths [m]
    std::vector<std::uint16_t> free_depth;  ///< in kDepthUnit, rounded down
  };
  static void count_through(const View& view, const Eigen::Vector3f& p_base, float voxel_size,
                            VoxelBlock& block);

  std::vector<View> views_;
  std::size_t stride_ = 1;
  std::size_t frames_ = 0;
};

}  // namespace pcavr
