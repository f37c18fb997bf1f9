// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/frame_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/check.hpp"
#include "pcavr/perception/reconstruction/surface_tiles.hpp"

namespace pcavr {
namespace {

constexpr int kPatch = 32;  ///< [px]
/// Pixels beyond a patch that its readings may change: a pixel of the halved image, and its nearest
/// neighbour where a lens is undistorted.
constexpr double kPatchMargin = 4.0;
/// Slope of the steepest ray: undistorted images end at 60 degrees from the optical axis, or are as
/// wide as the image.
constexpr double kSteepestRay = 100.0;

std::array<Eigen::Vector3d, 8> corners_of(const Eigen::AlignedBox3d& box) {
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
  }
  return corners;
}

}  // namespace

ReachFinder::ReachFinder(const CameraModel& camera, const TsdfOptions& options)
    : camera_(camera),
      options_(options),
      patches_x_((camera.width + kPatch - 1) / kPatch),
      patches_y_((camera.height + kPatch - 1) / kPatch) {
  for (int y = 0; y < patches_y_; ++y) {
    for (int x = 0; x < patches_x_; ++x) cones_.push_back(cone_of(x, y));
  }
}

ReachFinder::Cone ReachFinder::cone_of(int patch_x, int patch_y) const {
  const double left = patch_x * kPatch - kPatchMargin;
  const double top = patch_y * kPatch - kPatchMargin;
  const double right = std::min((patch_x + 1) * kPatch, camera_.width) + kPatchMargin;
  const double bottom = std::min((patch_y + 1) * kPatch, camera_.height) + kPatchMargin;
  const CameraModel pinhole = camera_.undistorted();
  Cone cone{Eigen::Vector2d::Constant(kSteepestRay), Eigen::Vector2d::Constant(-kSteepestRay)};
  const auto add = [&](double u, double v) {
    const Eigen::Vector2d pixel(std::clamp(u, 0.0, camera_.width - 1.0),
                                std::clamp(v, 0.0, camera_.height - 1.0));
    Eigen::Vector2d ray = camera_.normalise(pixel);
    if (!ray.allFinite()) {
      cone = {Eigen::Vector2d::Constant(-kSteepestRay), Eigen::Vector2d::Constant(kSteepestRay)};
      return;
    }
    // The margin beyond the image's border, at the focal length.
    ray += (Eigen::Vector2d(u, v) - pixel).cwiseQuotient(Eigen::Vector2d(pinhole.fx, pinhole.fy));
    cone.low = cone.low.cwiseMin(ray);
    cone.high = cone.high.cwiseMax(ray);
  };
  // Along the border: a lens bends it.
  for (int i = 0; i <= kPatch; i += 2) {
    const double u = left + (right - left) * i / kPatch;
    const double v = top + (bottom - top) * i / kPatch;
    add(u, top);
    add(u, bottom);
    add(left, v);
    add(right, v);
  }
  return cone;
}

FrameReach ReachFinder::reach_of(const DepthImage& depth, const Pose& T_base_camera) const {
  PCAVR_REQUIRE(depth.width() == camera_.width && depth.height() == camera_.height, depth.width(),
                depth.height());
  const auto min_depth = static_cast<float>(options_.depth_noise.min_depth);
  const auto max_depth = static_cast<float>(options_.depth_noise.max_depth);
  FrameReach reach{T_base_camera.inverse(), std::vector<float>(cones_.size(), 0.0F)};
  for (int v = 0; v < depth.height(); ++v) {
    float* patches = reach.patch_depths.data() + v / kPatch * patches_x_;
    for (int u = 0; u < depth.width(); ++u) {
      const float z = depth(u, v);
      if (z >= min_depth && z <= max_depth) patches[u / kPatch] = std::max(patches[u / kPatch], z);
    }
  }
  const float farthest = *std::max_element(reach.patch_depths.begin(), reach.patch_depths.end());
  // Rows of voxels that begin in front of the farthest band of the image are fused.
  const double end = farthest + band_at(farthest) + kTsdfBlockVoxels * options_.voxel_size;
  for (float& z : reach.patch_depths) {
    if (z == 0.0F) continue;
    const double slanted = z + band_at(z) * steepest_slope(z);
    z = static_cast<float>(1.01 * std::min(end, slanted));  // the tables of noise have steps
  }
  return reach;
}

double ReachFinder::band_at(double z) const {
  return std::max(options_.truncation_voxels * options_.voxel_size,
                  options_.truncation_std * options_.depth_noise.depth_std(z));
}

double ReachFinder::steepest_slope(double z) const {
  // Bands end at a distance from the plane that was fitted around a pixel of the halved image, not
  // along its ray. Neighbours in the fit differ by at most 70 degrees over two pixels and by noise;
  // four times that bounds the slope of a plane through few of them.
  constexpr double kFitSlope = 2.0 * 2.75;
  const double noise = 3.0 * std::numbers::sqrt2 * options_.depth_noise.depth_std(z);
  const double focal = 0.5 * std::max(camera_.fx, camera_.fy);
  return 4.0 * std::numbers::sqrt2 * (kFitSlope + noise * focal / z);
}

bool ReachFinder::sees(const FrameReach& reach, const Eigen::AlignedBox3d& box_base) const {
  std::array<Eigen::Vector3d, 8> corners = corners_of(box_base);
  for (Eigen::Vector3d& corner : corners) corner = reach.T_camera_base * corner;
  const auto all = [&](const auto& is_outside) {
    return std::all_of(corners.begin(), corners.end(), is_outside);
  };
  if (all([](const Eigen::Vector3d& p) { return p.z() <= 0.0; })) return false;
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    const double depth = double{reach.patch_depths[i]};
    const Cone& cone = cones_[i];
    if (depth == 0.0) continue;
    // A convex body outside one plane of the cone is outside the cone; others may be, too.
    if (all([&](const Eigen::Vector3d& p) { return p.z() > depth; }) ||
        all([&](const Eigen::Vector3d& p) { return p.x() < cone.low.x() * p.z(); }) ||
        all([&](const Eigen::Vector3d& p) { return p.x() > cone.high.x() * p.z(); }) ||
        all([&](const Eigen::Vector3d& p) { return p.y() < cone.low.y() * p.z(); }) ||
        all([&](const Eigen::Vector3d& p) { return p.y() > cone.high.y() * p.z(); })) {
      continue;
    }
    return true;
  }
  return false;
}

Eigen::AlignedBox3d ReachFinder::bounds(const FrameReach& reach) const {
  const Pose T_base_camera = reach.T_camera_base.inverse();
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    const double z = double{reach.patch_depths[i]};
    if (z == 0.0) continue;
    box.extend(T_base_camera.translation());
    for (const double x : {cones_[i].low.x(), cones_[i].high.x()}) {
      for (const double y : {cones_[i].low.y(), cones_[i].high.y()}) {
        box.extend(T_base_camera * Eigen::Vector3d(x * z, y * z, z));
      }
    }
  }
  return box;
}

}  // namespace pcavr
