// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/cad_simplification.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/base/model/mesh_simplification.hpp"

#include "base/model/vertex_clustering.hpp"

namespace pcavr::model {
namespace {

// Edge collapse takes some 200 bytes and 10 us per triangle: larger meshes are clustered first.
constexpr std::size_t kMaxCollapsedDirectly = 300'000;
// Target number of clusters. Each gives about two triangles, of which edge collapse removes nine in
// ten, where the surface is flattest.
constexpr double kClusters = 100'000.0;
// Clusters that a grid makes per cell's area of a surface.
constexpr double kClustersPerCellArea = 1.75;
constexpr double kSamplesAcross = 256.0;        // of the diagonal: 1 mm on a body of 0.25 m
constexpr std::size_t kMaxSamples = 2'000'000;  // on large triangles: a second of work
constexpr std::size_t kGrain = 8192;            // points per parallel task
constexpr double kRounding = 1e-7;              // [m] of single precision coordinates of a metre

/// A triangle by its longest edge and the corner opposite, and how finely it is sampled.
struct SampledTriangle {
  Eigen::Vector3f from = Eigen::Vector3f::Zero();
  Eigen::Vector3f along = Eigen::Vector3f::Zero();  ///< the longest edge
  Eigen::Vector3f to_tip = Eigen::Vector3f::Zero();
  std::size_t rows = 1;     ///< across, toward the tip
  std::size_t columns = 1;  ///< along the longest edge

  SampledTriangle(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t, double spacing) {
    double longest = -1.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f& a = mesh.vertices[t[i]];
      const Eigen::Vector3f& b = mesh.vertices[t[(i + 1) % 3]];
      const auto length = static_cast<double>((b - a).norm());
      if (length <= longest) continue;
      longest = length;
      from = a;
      along = b - a;
      to_tip = mesh.vertices[t[(i + 2) % 3]] - a;
    }
    const auto doubled_area = static_cast<double>(along.cross(to_tip).norm());
    columns = std::max<std::size_t>(1, static_cast<std::size_t>(longest / spacing));
    if (longest > 0.0) {
      rows = std::max<std::size_t>(1, static_cast<std::size_t>(doubled_area / longest / spacing));
    }
  }
  [[nodiscard]] bool is_large() const { return rows > 1 || columns > 1; }
};

/// Sample points of the distance, in addition to the vertices: a grid on large triangles.
std::vector<Eigen::Vector3f> points_on_large_triangles(const TriangleMesh& mesh, double spacing) {
  for (;; spacing *= 2.0) {
    std::size_t count = 0;
    for (const auto& t : mesh.triangles) {
      const SampledTriangle triangle(mesh, t, spacing);
      if (triangle.is_large()) count += triangle.rows * triangle.columns;
    }
    if (count <= kMaxSamples) break;
  }
  std::vector<Eigen::Vector3f> points;
  for (const auto& t : mesh.triangles) {
    const SampledTriangle triangle(mesh, t, spacing);
    if (!triangle.is_large()) continue;
    for (std::size_t i = 0; i < triangle.rows; ++i) {
      const float v = (static_cast<float>(i) + 0.5F) / static_cast<float>(triangle.rows);
      for (std::size_t k = 0; k < triangle.columns; ++k) {
        const float u = (static_cast<float>(k) + 0.5F) / static_cast<float>(triangle.columns);
        points.emplace_back(triangle.from + (1.0F - v) * u * triangle.along + v * triangle.to_tip);
      }
    }
  }
  return points;
}

float max_distance(const std::vector<Eigen::Vector3f>& points, const SurfaceQuery& surface,
                   float diagonal) {
  std::vector<float> maxima((points.size() + kGrain - 1) / kGrain, 0.0F);
  parallel_for(Parallelism::max(), points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    float& max = maxima[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) {
      // A small search radius first: nearly all points lie next to the surface.
      for (float radius = std::max(2.0F * max, 1e-4F * diagonal);; radius *= 8.0F) {
        const auto nearest = surface.closest(points[i], radius);
        if (nearest) max = std::max(max, nearest->distance);
        if (nearest || radius > diagonal) break;
      }
    }
  });
  return maxima.empty() ? 0.0F : *std::max_element(maxima.begin(), maxima.end());
}

}  // namespace

TriangleMesh simplified_cad(const TriangleMesh& full, std::size_t max_triangles, double max_error) {
  if (full.triangles.size() <= kMaxCollapsedDirectly) {
    return simplified(full, max_triangles, max_error);
  }
  const double cell = std::sqrt(kClustersPerCellArea * surface_area(full) / kClusters);
  return simplified(cluster_vertices(full, cell), max_triangles, max_error);
}

double hausdorff_distance(const TriangleMesh& full, const TriangleMesh& simple) {
  PCAVR_REQUIRE(!full.triangles.empty() && !simple.triangles.empty());
  const SurfaceQuery surface(simple);
  const float diagonal = bounds(full.vertices).diagonal().norm();
  const double spacing = static_cast<double>(diagonal) / kSamplesAcross;
  const float at_vertices = max_distance(full.vertices, surface, diagonal);
  const float between = max_distance(points_on_large_triangles(full, spacing), surface, diagonal);
  const auto distance = static_cast<double>(std::max(at_vertices, between));
  return std::ceil(distance / kRounding) * kRounding;
}

}  // namespace pcavr::model
