// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

namespace pcavr {
namespace {

/// Rays are cast for every second pixel of every second row; dilation closes the gaps.
constexpr int kStride = 2;
/// Standard deviations in front of the body from which a reading belongs to an occluder.
constexpr double kOccluderGate = 3.0;

constexpr float kNoSurface = std::numeric_limits<float>::infinity();

/// Rendered depth of a body in a part of the image; infinite outside the body.
struct Silhouette {
  PixelRectangle area;
  int columns = 0;
  int rows = 0;
  std::vector<float> min_depth;  ///< row-major [m]

  [[nodiscard]] float& at(int column, int row) {
    return min_depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(column)];
  }
};

PixelRectangle expanded(const PixelRectangle& area, int margin, const CameraModel& camera) {
  return {std::max(area.x_begin - margin, 0), std::max(area.y_begin - margin, 0),
          std::min(area.x_end + margin, camera.width),
          std::min(area.y_end + margin, camera.height)};
}

Silhouette cast_silhouette(const SurfaceQuery& surface_object, const Pose& T_object_camera,
                           const CameraModel& camera, const PixelRectangle& seen, int margin) {
  Silhouette silhouette;
  silhouette.area = expanded(seen, margin, camera);
  silhouette.columns = silhouette.area.x_end - silhouette.area.x_begin;
  silhouette.rows = silhouette.area.y_end - silhouette.area.y_begin;
  silhouette.min_depth.assign(
      static_cast<std::size_t>(silhouette.columns) * static_cast<std::size_t>(silhouette.rows),
      kNoSurface);
  const Eigen::Matrix3d R_object_camera = T_object_camera.rotation_matrix();
  const Eigen::Vector3f origin = T_object_camera.translation().cast<float>();
  for (int y = seen.y_begin; y < seen.y_end; y += kStride) {
    for (int x = seen.x_begin; x < seen.x_end; x += kStride) {
      const Eigen::Vector3d ray = camera.unproject({x, y}, 1.0);
      const auto hit = surface_object.cast(origin, (R_object_camera * ray).cast<float>());
      if (!hit) continue;
      silhouette.at(x - silhouette.area.x_begin, y - silhouette.area.y_begin) =
          hit->distance / static_cast<float>(ray.norm());
    }
  }
  return silhouette;
}

/// Minimum filter along a line of `count` values, over neighbours up to `reach` away.
void min_filter(float* values, int count, std::ptrdiff_t step, int reach,
                std::vector<float>& line) {
  line.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) line[static_cast<std::size_t>(i)] = values[i * step];
  for (int i = 0; i < count; ++i) {
    const auto from = line.begin() + std::max(i - reach, 0);
    const auto to = line.begin() + std::min(i + reach + 1, count);
    values[i * step] = *std::min_element(from, to);
  }
}

/// Dilation by a square of (2 reach + 1)^2 pixels; overlaps take the nearest depth.
void dilate(Silhouette& silhouette, int reach) {
  std::vector<float> line;
  for (int row = 0; row < silhouette.rows; ++row) {
    min_filter(&silhouette.at(0, row), silhouette.columns, 1, reach, line);
  }
  for (int column = 0; column < silhouette.columns; ++column) {
    min_filter(&silhouette.at(column, 0), silhouette.rows, silhouette.columns, reach, line);
  }
}

}  // namespace

void mask_body(const SurfaceQuery& surface_object, const Pose& T_camera_object,
               const CameraModel& camera, const DepthImage& depth, const DepthNoise& noise,
               int margin_pixels, MaskImage& mask) {
  PCAVR_REQUIRE(margin_pixels >= 0, margin_pixels);
  PCAVR_REQUIRE(mask.width() == camera.width && mask.height() == camera.height, mask.width(),
                mask.height());
  PCAVR_REQUIRE(depth.width() == camera.width && depth.height() == camera.height, depth.width(),
                depth.height());
  const Pose T_object_camera = T_camera_object.inverse();
  const PixelRectangle seen = visible_rectangle(surface_object.bounds(), camera, T_object_camera);
  if (seen.empty()) return;
  const int reach = margin_pixels + kStride;
  Silhouette silhouette = cast_silhouette(surface_object, T_object_camera, camera, seen, reach);
  dilate(silhouette, reach);
  for (int row = 0; row < silhouette.rows; ++row) {
    for (int column = 0; column < silhouette.columns; ++column) {
      const float surface = silhouette.at(column, row);
      if (surface == kNoSurface) continue;
      const int x = silhouette.area.x_begin + column;
      const int y = silhouette.area.y_begin + row;
      const double margin = kOccluderGate * noise.depth_std(static_cast<double>(surface));
      const bool is_measured = depth(x, y) > 0.0F;
      if (!is_measured || depth(x, y) > surface - static_cast<float>(margin)) mask(x, y) = 1;
    }
  }
}

}  // namespace pcavr
