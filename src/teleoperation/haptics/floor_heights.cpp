// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/floor_heights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace pcavr::detail {
namespace {

constexpr double kMinLevelNormalZ = 0.7;
constexpr double kMaxCells = 1000.0;  // along an axis: bounds the memory of a wide scan
constexpr int kMaxSamples = 2000;     // along a triangle's edge

}  // namespace

FloorHeights::FloorHeights(const TriangleMesh& mesh,
                           const std::vector<std::vector<Eigen::Vector3d>>& supports_base,
                           double height_tolerance) {
  double ceiling = std::numeric_limits<double>::infinity();
  for (const auto& outline : supports_base) {
    for (const Eigen::Vector3d& corner : outline) ceiling = std::min(ceiling, corner.z());
  }
  ceiling -= height_tolerance;
  if (mesh.triangles.empty() || !std::isfinite(ceiling)) return;
  const Eigen::AlignedBox3d box = bounds(mesh.vertices).cast<double>();
  low_ = box.min().head<2>();
  cell_ = std::max(cell_, box.sizes().head<2>().maxCoeff() / kMaxCells);
  cells_ = (box.sizes().head<2>().array() / cell_).floor() + 1.0;
  heights_.resize(static_cast<std::size_t>(cells_.x() * cells_.y()));
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>();
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (!(normal.z() > kMinLevelNormalZ * normal.norm())) continue;
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(2.0 * longest / cell_)), 1, kMaxSamples);
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n - i; ++j) {
        const Eigen::Vector3d p = (i * a + j * b + (n - i - j) * c) / n;
        const auto cell = cell_of(p.head<2>());
        if (!cell || p.z() > ceiling) continue;
        std::optional<float>& height = heights_[*cell];
        height = std::max(height.value_or(static_cast<float>(p.z())), static_cast<float>(p.z()));
      }
    }
  }
}

std::optional<std::size_t> FloorHeights::cell_of(const Eigen::Vector2d& p) const noexcept {
  const Eigen::Array2d cell = ((p - low_).array() / cell_).floor();
  if ((cell < 0.0).any() || (cell >= cells_).any()) return std::nullopt;
  return static_cast<std::size_t>(cell.y() * cells_.x() + cell.x());
}

std::optional<double> FloorHeights::below(const Eigen::Vector2d& p_base,
                                          double from) const noexcept {
  const auto cell = cell_of(p_base);
  if (!cell || !heights_[*cell] || *heights_[*cell] >= from) return std::nullopt;
  return *heights_[*cell];
}

}  // namespace pcavr::detail
