// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/reconstruction/surface_tiles.hpp"

namespace pcavr {

/// The registered cloud: the measured points of all frames in base, averaged in the cubes of a grid
/// (voxels). A point's weight is inverse to the variance of its depth; its normal is that of the
/// depth image, toward the camera. A quarter of the pixels of each frame is used. Memory grows with
/// the surface that was seen, 64 bytes for each voxel, not with the frames. Deterministic; not
/// thread-safe.
class MeasuredCloud {
 public:
  /// `voxel_size` in metres, > 0. With a `part`, only points in its blocks of 8^3 voxels and those
  /// next to it are kept.
  MeasuredCloud(double voxel_size, const DepthNoise& noise,
                const std::optional<BlockBox>& part = {});
  ~MeasuredCloud();
  MeasuredCloud(MeasuredCloud&&) noexcept;

  /// Adds a frame. Depth, colour (may be empty) and mask (empty: none; non-zero: left out) share
  /// one pixel grid. Run filter_depth first. Points without a neighbour for a normal along each
  /// axis, or farther than a million voxels from base, are left out.
  void add(const DepthImage& depth, const ColorImage& color, const MaskImage& is_dynamic,
           const CameraModel& camera, const Pose& T_base_camera);
  /// Counts a frame that sees nothing of the part, in the place of add().
  void add_unseen();

  /// The points of the voxels that at least `min_frames` frames measured, in the order in which
  /// they were seen first: with normals, and with colours where frames had them. Where noise
  /// spreads a surface over several layers of voxels, those with less than half the weight of
  /// another layer are left out.
  [[nodiscard]] PointCloud points(int min_frames) const;

  [[nodiscard]] std::size_t voxel_count() const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The points in the blocks of a box.
[[nodiscard]] PointCloud points_in(const PointCloud& cloud, const BlockBox& box, double voxel_size);

/// The points within `max_distance` [m] of one of the mesh's vertices, along each axis, and some up
/// to twice as far: vertices are looked up in a grid of that spacing. Things that space carving
/// removed from the mesh, such as moving ones, are so removed from the cloud.
[[nodiscard]] PointCloud points_near(const PointCloud& cloud, const TriangleMesh& mesh,
                                     double max_distance);
/// The same of all parts of a cloud, each of which is freed before the next one is looked at.
[[nodiscard]] PointCloud points_near(std::vector<PointCloud>&& parts, const TriangleMesh& mesh,
                                     double max_distance);

}  // namespace pcavr
