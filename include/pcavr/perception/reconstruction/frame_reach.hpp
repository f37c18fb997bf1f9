// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"

namespace pcavr {

/// The space that a frame can change in a volume: for each patch of the image, from the camera to
/// the end of the truncation band behind the farthest depth.
struct FrameReach {
  Pose T_camera_base;
  std::vector<float> patch_depths;  ///< along the optical axis [m]; 0: nothing was measured
};

/// Finds what the frames of one camera reach, without fusing them. Never too little, and a margin
/// of some pixels too much. Const members may run concurrently.
class ReachFinder {
 public:
  /// `camera` is that of the depth images.
  ReachFinder(const CameraModel& camera, const TsdfOptions& options);

  [[nodiscard]] FrameReach reach_of(const DepthImage& depth, const Pose& T_base_camera) const;
  [[nodiscard]] bool sees(const FrameReach& reach, const Eigen::AlignedBox3d& box_base) const;
  /// A box around the reach.
  [[nodiscard]] Eigen::AlignedBox3d bounds(const FrameReach& reach) const;

 private:
  /// The rays of a patch: bounds of x and y on the plane z = 1.
  struct Cone {
    Eigen::Vector2d low;
    Eigen::Vector2d high;
  };
  [[nodiscard]] Cone cone_of(int patch_x, int patch_y) const;
  /// Half the width of the truncation band at a depth [m].
  [[nodiscard]] double band_at(double z) const;
  /// The largest slope of a plane that a pixel at a depth may have, relative to its ray.
  [[nodiscard]] double steepest_slope(double z) const;

  CameraModel camera_;
  TsdfOptions options_;
  int patches_x_;
  int patches_y_;
  std::vector<Cone> cones_;  ///< row-major
};

}  // namespace pcavr
