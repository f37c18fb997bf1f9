// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/cloud/ray_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

/// Coordinates on a grid differ by whole steps, but for rounding of single precision: by less than
/// this, or by much more [tangents]. Finer grids than 100 times this are not searched.
constexpr double kRounding = 5e-6;
constexpr std::size_t kMinColumns = 16;
/// rms distance of the coordinates from the grid [steps].
constexpr double kMaxGridResidual = 0.02;
constexpr double kMaxGridPixels = 4096.0;

/// Positions at whole steps: number = scale * coordinate + offset.
struct Grid {
  double scale = 0.0;
  double offset = 0.0;
};

/// The means of the groups of coordinates that differ by rounding alone.
std::vector<double> grouped(std::vector<float> coordinates) {
  std::sort(coordinates.begin(), coordinates.end());
  std::vector<double> means;
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const auto x = static_cast<double>(coordinates[i]);
    if (i > 0 && x - static_cast<double>(coordinates[i - 1]) > kRounding) {
      means.push_back(sum / count);
      sum = count = 0.0;
    }
    sum += x;
    ++count;
  }
  if (count > 0.0) means.push_back(sum / count);
  return means;
}

std::optional<Grid> find_grid(const std::vector<Eigen::Vector2f>& rays, int axis) {
  std::vector<float> coordinates;
  coordinates.reserve(rays.size());
  for (const Eigen::Vector2f& ray : rays) coordinates.push_back(ray[axis]);
  const std::vector<double> columns = grouped(std::move(coordinates));
  if (columns.size() < kMinColumns || static_cast<double>(columns.size()) > kMaxGridPixels) {
    return std::nullopt;
  }
  std::vector<double> gaps;
  for (std::size_t i = 1; i < columns.size(); ++i) gaps.push_back(columns[i] - columns[i - 1]);
  const double step = median(std::move(gaps));
  if (!(step > 100.0 * kRounding)) return std::nullopt;
  // Least squares of the number against the coordinate. Numbers grow by rounded gaps, so that an
  // error of the step does not add up.
  double n = 0, x = 0, k = 0, xx = 0, xk = 0, number = 0;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i > 0) number += std::round((columns[i] - columns[i - 1]) / step);
    numbers.push_back(number);
    ++n;
    x += columns[i];
    k += number;
    xx += columns[i] * columns[i];
    xk += columns[i] * number;
  }
  const Grid grid{.scale = (n * xk - x * k) / (n * xx - x * x),
                  .offset = (k - (n * xk - x * k) / (n * xx - x * x) * x) / n};
  double sum = 0.0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    sum += std::pow(grid.scale * columns[i] + grid.offset - numbers[i], 2);
  }
  if (!(std::sqrt(sum / n) < kMaxGridResidual)) return std::nullopt;
  return grid;
}

/// Moves the numbers so that the first of `all_rays` is 0; returns how many there are.
int first_at_zero(const std::vector<Eigen::Vector2f>& all_rays, int axis, Grid& grid) {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2f& ray : all_rays) {
    const double number = grid.scale * static_cast<double>(ray[axis]) + grid.offset;
    low = std::min(low, number);
    high = std::max(high, number);
  }
  grid.offset -= std::round(low);
  return static_cast<int>(std::min(high - std::round(low) + 1.5, 2.0 * kMaxGridPixels));
}

}  // namespace

std::optional<CameraModel> find_ray_grid(const std::vector<Eigen::Vector2f>& rays,
                                         const std::vector<Eigen::Vector2f>& all_rays) {
  std::optional<Grid> columns = find_grid(rays, 0);
  if (!columns) return std::nullopt;
  std::optional<Grid> rows = find_grid(rays, 1);
  if (!rows) return std::nullopt;
  CameraModel camera{.width = first_at_zero(all_rays, 0, *columns),
                     .height = first_at_zero(all_rays, 1, *rows)};
  if (camera.width > kMaxGridPixels || camera.height > kMaxGridPixels) return std::nullopt;
  camera.fx = columns->scale;
  camera.fy = rows->scale;
  camera.cx = columns->offset;
  camera.cy = rows->offset;
  return camera;
}

}  // namespace pcavr
