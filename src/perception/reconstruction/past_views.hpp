// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"

#include "perception/reconstruction/frame_surface.hpp"
#include "perception/reconstruction/voxel_block.hpp"

namespace pcavr {

/// Free space observed by past frames, for blocks that are added later. Without it, an object that
/// comes to rest in space that earlier frames observed as free would remain: blocks count only from
/// the frame that adds them. Views are sampled uniformly over time, at most kMaxViews, so that
/// memory does not grow with the recording.
class PastViews {
 public:
  static constexpr std::size_t kMaxViews = 64;  ///< 10 MB at 640 x 480

  /// Adds every n-th frame; n doubles whenever kMaxViews is reached.
  void add(const FrameSurface& frame, const Pose& T_base_camera);
  /// Counts a frame that saw none of the blocks: other frames are sampled as if it had been added.
  void add_unseen();

  /// Adds to each voxel's free count the number of views that observed it as free.
  void count_free_views(const BlockCoordinates& coordinates, double voxel_size,
                        VoxelBlock& block) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct View {
    Eigen::Matrix3f R_camera_base = Eigen::Matrix3f::Identity();
    Eigen::Vector3f p_camera_base = Eigen::Vector3f::Zero();
    float fx = 0.0F, fy = 0.0F, cx = 0.0F, cy = 0.0F;  ///< cx, cy: plus half a pixel, for rounding
    int width = 0, height = 0;
    float max_free_depth = 0.0F;                 ///< of all free depths [m]
    std::vector<std::uint16_t> free_depth = {};  ///< in kDepthUnit, rounded down
  };
  static void count_free_views(const View& view, const Eigen::Vector3f& p_base, float voxel_size,
                               VoxelBlock& block);
  /// Counts a frame, and makes room for it; false where it is not sampled.
  bool is_next_sampled();

  std::vector<View> views_;
  std::size_t stride_ = 1;
  std::size_t frames_ = 0;
};

}  // namespace pcavr
