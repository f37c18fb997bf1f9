// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_surface.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/geometry/pixel.hpp"

namespace pcavr::tracking {
namespace {

// About 160 cells across: point-to-plane alignment gains little from more [Newcombe et al. 2011
// use the same pyramid], and averaging over a cell removes most of the noise.
constexpr int kCellsAcross = 160;

// A larger depth step between the pixels of a cell is an edge (depth discontinuity); a plane seen
// at 80 degrees changes by 4 % over a cell.
constexpr float kMaxRelativeStep = 0.04F;

// Limit of the running average's weight, so that the model adapts to slow changes.
constexpr float kMaxWeight = 30.0F;

struct PlaneFit {
  float slope_x = 0.0F;  ///< per cell
  float slope_y = 0.0F;
  float mean = 0.0F;
  bool is_valid = false;
};

/// Least squares over a window of (2 reach + 1)^2 cells; invalid if a cell is empty or the
/// residuals are larger than noise of `noise_std`.
PlaneFit fit_plane(const InverseDepth& w, int width, int x, int y, int reach, float noise_std) {
  const auto at = [&](int i, int j) {
    return w[static_cast<std::size_t>((y + j) * width + x + i)];
  };
  const float centre = at(0, 0);
  float sum = 0.0F;
  float sum_squares = 0.0F;
  float moment_x = 0.0F;
  float moment_y = 0.0F;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      const float value = at(i, j);
      if (value <= 0.0F) return {};
      const float difference = value - centre;
      sum += difference;
      sum_squares += difference * difference;
      moment_x += static_cast<float>(i) * difference;
      moment_y += static_cast<float>(j) * difference;
    }
  }
  const auto count = static_cast<float>((2 * reach + 1) * (2 * reach + 1));
  const float sum_offsets2 = count * static_cast<float>(reach * (reach + 1)) / 3.0F;  // sum of i^2
  PlaneFit fit{moment_x / sum_offsets2, moment_y / sum_offsets2, centre + sum / count, false};
  const float residual = sum_squares - sum * sum / count -
                         sum_offsets2 * (fit.slope_x * fit.slope_x + fit.slope_y * fit.slope_y);
  fit.is_valid = residual < (count - 3.0F) * noise_std * noise_std;
  return fit;
}

/// Bilinear interpolation between the centres of four cells; 0 if one of them is empty or outside.
float interpolate(const InverseDepth& w, const CellGrid& grid, const Eigen::Vector2f& at) {
  // Checked before the cast to int, which overflows for points near the plane z = 0.
  const bool is_inside = at.x() >= 0.0F && at.y() >= 0.0F &&
                         at.x() < static_cast<float>(grid.width() - 1) &&
                         at.y() < static_cast<float>(grid.height() - 1);
  if (!is_inside) return 0.0F;
  const int x = static_cast<int>(at.x());
  const int y = static_cast<int>(at.y());
  const auto corner = static_cast<std::size_t>(y * grid.width() + x);
  const auto below = corner + static_cast<std::size_t>(grid.width());
  if (w[corner] <= 0.0F || w[corner + 1] <= 0.0F || w[below] <= 0.0F || w[below + 1] <= 0.0F) {
    return 0.0F;
  }
  const float u = at.x() - static_cast<float>(x);
  const float v = at.y() - static_cast<float>(y);
  return (1.0F - v) * ((1.0F - u) * w[corner] + u * w[corner + 1]) +
         v * ((1.0F - u) * w[below] + u * w[below + 1]);
}

}  // namespace

CellGrid::CellGrid(const CameraModel& full)
    : pixels(std::max(1, static_cast<int>(std::lround(full.width / double{kCellsAcross})))),
      camera(full.downsampled(pixels)) {
  rays.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d ray = camera.normalise(Eigen::Vector2d(x, y));
      rays.push_back(ray.cast<float>());
      if (!camera.has_distortion()) continue;
      Eigen::Matrix2d jacobian;
      (void)camera.distortion.distort(ray, &jacobian);
      lens_jacobians.push_back(jacobian.cast<float>());
    }
  }
}

CellProjector::CellProjector(const CellGrid& grid, const Pose& T_camera_points)
    : grid_(&grid),
      R_(T_camera_points.rotation_matrix().cast<float>()),
      t_(T_camera_points.translation().cast<float>()),
      focal_(static_cast<float>(grid.camera.fx), static_cast<float>(grid.camera.fy)),
      centre_(static_cast<float>(grid.camera.cx), static_cast<float>(grid.camera.cy)),
      has_distortion_(grid.camera.has_distortion()) {}

InverseDepth cell_inverse_depth(const CellGrid& grid, const DepthImage& depth,
                                const MaskImage& is_dynamic, const DepthNoise& noise) {
  PCAVR_REQUIRE(is_dynamic.empty() ||
                (is_dynamic.width() == depth.width() && is_dynamic.height() == depth.height()));
  const auto min_depth = static_cast<float>(noise.min_depth);
  const auto max_depth = static_cast<float>(noise.max_depth);
  InverseDepth cells(grid.size(), 0.0F);
  const int n = grid.pixels;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      float low = max_depth;
      float high = min_depth;
      float sum = 0.0F;
      bool is_complete = true;
      for (int j = 0; j < n && is_complete; ++j) {
        const auto row = depth.row(y * n + j).subspan(static_cast<std::size_t>(x * n),
                                                      static_cast<std::size_t>(n));
        for (const float z : row) {
          is_complete = is_complete && z >= min_depth && z <= max_depth;
          low = std::min(low, z);
          high = std::max(high, z);
          sum += 1.0F / z;
        }
      }
      if (!is_complete) continue;
      const float step = kMaxRelativeStep * low + 6.0F * static_cast<float>(noise.depth_std(low));
      if (high - low > step) continue;
      bool is_static = true;
      if (!is_dynamic.empty()) {
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i < n; ++i)
            is_static = is_static && is_dynamic(x * n + i, y * n + j) == 0;
        }
      }
      if (is_static) {
        cells[static_cast<std::size_t>(y * grid.width() + x)] = sum / static_cast<float>(n * n);
      }
    }
  }
  return cells;
}

Surface make_surface(const CellGrid& grid, const InverseDepth& inverse_depth,
                     const DepthNoise& noise) {
  const int width = grid.width();
  Surface surface;
  surface.points.assign(grid.size(), Eigen::Vector3f::Zero());
  surface.normals.assign(grid.size(), Eigen::Vector3f::Zero());
  const auto step_x = static_cast<float>(grid.camera.fx);  // cells per unit on the plane z = 1
  const auto step_y = static_cast<float>(grid.camera.fy);
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < width; ++x) {
      const auto cell = static_cast<std::size_t>(y * width + x);
      const float w = inverse_depth[cell];
      if (w <= 0.0F) continue;
      const Eigen::Vector2f ray = grid.rays[cell];
      surface.points[cell] = Eigen::Vector3f(ray.x(), ray.y(), 1.0F) / w;
      if (x < 2 || y < 2 || x >= width - 2 || y >= grid.height() - 2) continue;
      const float noise_std = static_cast<float>(noise.depth_std(1.0 / double{w})) * w * w;
      PlaneFit fit = fit_plane(inverse_depth, width, x, y, 2, noise_std);
      if (!fit.is_valid) fit = fit_plane(inverse_depth, width, x, y, 1, noise_std);
      if (!fit.is_valid) continue;
      // A plane has 1/z = a x + b y + c, so that (a, b, c) . p = 1: (a, b, c) is its normal.
      Eigen::Vector2f slope(fit.slope_x * step_x, fit.slope_y * step_y);
      if (!grid.lens_jacobians.empty())
        slope = (grid.lens_jacobians[cell].transpose() * slope).eval();
      const float a = slope.x();
      const float b = slope.y();
      const Eigen::Vector3f normal(a, b, fit.mean - a * ray.x() - b * ray.y());
      surface.normals[cell] = normal.normalized();
    }
  }
  return surface;
}

std::optional<Eigen::Vector3d> point_at(const CellGrid& grid, const Surface& surface,
                                        const CameraModel& full, const Eigen::Vector2d& pixel) {
  const std::optional<int> column = pixel_index(pixel.x(), full.width);
  const std::optional<int> row = pixel_index(pixel.y(), full.height);
  if (!column || !row) return std::nullopt;
  const int x = *column / grid.pixels;
  const int y = *row / grid.pixels;
  if (x >= grid.width() || y >= grid.height()) return std::nullopt;
  const auto cell = static_cast<std::size_t>(y * grid.width() + x);
  const Eigen::Vector3d normal = surface.normals[cell].cast<double>();
  if (normal.isZero()) return std::nullopt;
  const Eigen::Vector3d ray = full.normalise(pixel).homogeneous();
  const double slope = normal.dot(ray);
  const double z = normal.dot(surface.points[cell].cast<double>()) / slope;
  // The plane does not determine the depth of a pixel at an incidence above 84 degrees.
  if (std::abs(slope) < 0.1 * ray.norm() || !(z > 0.0)) return std::nullopt;
  return ray * z;
}

void fuse(const CellGrid& grid, const Surface& surface, const InverseDepth& frame,
          const Pose& T_model_frame, const DepthNoise& noise, SurfaceModel& model) {
  const CellProjector to_frame(grid, T_model_frame.inverse());
  for (std::size_t cell = 0; cell < surface.points.size(); ++cell) {
    const Eigen::Vector3f& normal = surface.normals[cell];
    if (normal.isZero()) continue;
    const Eigen::Vector3f p_frame = to_frame.transform(surface.points[cell]);
    if (p_frame.z() <= 0.0F) continue;
    const float w = interpolate(frame, grid, to_frame.cell(p_frame));
    if (w <= 0.0F) continue;
    // The measured point lies on the frame's ray: shift it along the plane onto the model's ray.
    const float plane_distance =
        (1.0F / w / p_frame.z() - 1.0F) * (to_frame.rotation() * normal).dot(p_frame);
    const float z = surface.points[cell].z();
    if (std::abs(plane_distance) > 3.0F * static_cast<float>(noise.depth_std(z))) continue;
    const float measured = 1.0F / (z + plane_distance * z / normal.dot(surface.points[cell]));
    float& weight = model.weight[cell];
    float& mean = model.inverse_depth[cell];
    mean += (measured - mean) / (weight + 1.0F);
    weight = std::min(weight + 1.0F, kMaxWeight);
  }
  ++model.frames;
}

}  // namespace pcavr::tracking
