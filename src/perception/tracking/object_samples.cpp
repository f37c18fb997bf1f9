// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/tracking/object_samples.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pcavr::tracking {
namespace {

/// Cosine of the maximum incidence angle of a reliable depth reading.
constexpr double kMinSampleCosine = 0.26;  // 75 degrees

}  // namespace

SampleGrid::SampleGrid(const SurfaceQuery& surface_object, const SmoothNormals& normals_object,
                       const CameraModel& camera, const DepthImage& depth,
                       const Pose& T_camera_object, int max_samples)
    : surface_(surface_object), normals_(normals_object) {
  const PixelRectangle area =
      visible_rectangle(surface_object.bounds(), camera, T_camera_object.inverse());
  if (area.empty()) return;
  const int width = area.x_end - area.x_begin;
  const int height = area.y_end - area.y_begin;
  while ((width / stride_) * (height / stride_) > max_samples) ++stride_;
  columns_ = (width + stride_ - 1) / stride_;
  rows_ = (height + stride_ - 1) / stride_;
  cells_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const int x = area.x_begin + column * stride_;
      const int y = area.y_begin + row * stride_;
      cells_.push_back({camera.unproject({x, y}, 1.0), static_cast<double>(depth(x, y))});
    }
  }
}

std::vector<SurfaceSample> SampleGrid::samples(const Pose& T_camera_object) const {
  const Pose T_object_camera = T_camera_object.inverse();
  const Eigen::Matrix3d R_object_camera = T_object_camera.rotation_matrix();
  const Eigen::Vector3f origin = T_object_camera.translation().cast<float>();
  std::vector<std::optional<SurfaceQuery::Hit>> hits(cells_.size());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    hits[i] = surface_.cast(origin, (R_object_camera * cells_[i].ray_camera).cast<float>());
  }
  std::vector<SurfaceSample> samples;
  samples.reserve(cells_.size());
  const auto columns = static_cast<std::size_t>(columns_);
  for (int row = 1; row + 1 < rows_; ++row) {
    for (int column = 1; column + 1 < columns_; ++column) {
      const std::size_t i =
          static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
      const Cell& cell = cells_[i];
      if (!(cell.measured_depth > 0.0) || !hits[i] || !hits[i - 1] || !hits[i + 1] ||
          !hits[i - columns] || !hits[i + columns]) {
        continue;
      }
      const Eigen::Vector3d ray_object = R_object_camera * cell.ray_camera;
      const double length = ray_object.norm();
      const Eigen::Vector3d normal = normals_.at(*hits[i]);
      if (-normal.dot(ray_object) < kMinSampleCosine * length) continue;
      const double expected = static_cast<double>(hits[i]->distance) / length;
      samples.push_back({T_object_camera.translation() + expected * ray_object, normal, ray_object,
                         expected, cell.measured_depth});
    }
  }
  return samples;
}

}  // namespace pcavr::tracking
