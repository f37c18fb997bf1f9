// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/vertex_clustering.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "base/model/quadric.hpp"

namespace pcavr::model {
namespace {

using Corners = std::array<std::uint32_t, 3>;

// Cells along an axis: a key has 20 bits for each.
constexpr double kMaxCells = 1 << 20;
// Regularisation toward a cluster's centroid: determines the point along a flat surface, and shifts
// the optimum by a thousandth of the distance.
constexpr double kCentroidWeight = 1e-3;

Eigen::Vector3d point(const TriangleMesh& mesh, std::uint32_t vertex) {
  return mesh.vertices[vertex].cast<double>();
}

Eigen::Vector3d doubled_area(const TriangleMesh& mesh, const Corners& t) {
  const Eigen::Vector3d a = point(mesh, t[0]);
  return (point(mesh, t[1]) - a).cross(point(mesh, t[2]) - a);
}

/// The cube face, 0 to 5, of a direction's dominant axis.
std::uint64_t side_of(const Eigen::Vector3f& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint64_t>(2 * axis + (direction[axis] < 0.0F ? 1 : 0));
}

/// The index of each vertex's cluster, in the order of the vertices.
struct Clusters {
  std::vector<std::uint32_t> of_vertex;
  std::uint32_t count = 0;
};

Clusters find_clusters(const TriangleMesh& mesh, double cell) {
  std::vector<Eigen::Vector3f> normals(mesh.vertices.size(), Eigen::Vector3f::Zero());
  for (const Corners& t : mesh.triangles) {
    const Eigen::Vector3f normal = doubled_area(mesh, t).cast<float>();
    for (const std::uint32_t v : t) normals[v] += normal;
  }
  const Eigen::Vector3d origin = bounds(mesh.vertices).min().cast<double>();
  Clusters clusters;
  clusters.of_vertex.reserve(mesh.vertices.size());
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    std::uint64_t key = side_of(normals[v]);
    for (int axis = 0; axis < 3; ++axis) {
      const double index = std::floor((point(mesh, v)[axis] - origin[axis]) / cell);
      key = key << 20U | static_cast<std::uint64_t>(std::clamp(index, 0.0, kMaxCells - 1.0));
    }
    const auto [entry, is_new] = numbers.try_emplace(key, clusters.count);
    if (is_new) ++clusters.count;
    clusters.of_vertex.push_back(entry->second);
  }
  return clusters;
}

/// The point of minimum error to all planes; near `centroid` in directions that they do not
/// determine.
Eigen::Vector3d best_point(const Quadric& q, const Eigen::Vector3d& centroid) {
  Eigen::Matrix3d a;
  a << q.xx, q.xy, q.xz, q.xy, q.yy, q.yz, q.xz, q.yz, q.zz;
  const double trace = a.trace();
  if (!(trace > 0.0)) return centroid;
  const Eigen::Vector3d gradient = a * centroid + q.b;
  a.diagonal().array() += kCentroidWeight * trace;
  return centroid - a.ldlt().solve(gradient);
}

std::vector<Eigen::Vector3f> place_clusters(const TriangleMesh& mesh, const Clusters& clusters,
                                            double cell) {
  // Relative to the centre of the mesh the quadrics have small values and little rounding error.
  const Eigen::Vector3d origin = bounds(mesh.vertices).center().cast<double>();
  std::vector<Quadric> quadrics(clusters.count);
  for (const Corners& t : mesh.triangles) {
    const Eigen::Vector3d normal = doubled_area(mesh, t);
    const double length = normal.norm();
    if (!(length > 0.0)) continue;
    for (const std::uint32_t v : t) {
      quadrics[clusters.of_vertex[v]].add_plane(normal / length, point(mesh, t[0]) - origin,
                                                length);
    }
  }
  std::vector<Eigen::Vector3d> sums(clusters.count, Eigen::Vector3d::Zero());
  std::vector<double> counts(clusters.count, 0.0);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    sums[clusters.of_vertex[v]] += point(mesh, v) - origin;
    counts[clusters.of_vertex[v]] += 1.0;
  }
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(clusters.count);
  for (std::uint32_t c = 0; c < clusters.count; ++c) {
    const Eigen::Vector3d centroid = sums[c] / counts[c];
    const Eigen::Vector3d best = best_point(quadrics[c], centroid);
    // An optimum far outside the cell is ill-conditioned.
    const bool is_near = (best - centroid).norm() < cell;
    positions.push_back(((is_near ? best : centroid) + origin).cast<float>());
  }
  return positions;
}

/// Rotated to begin with the lowest index; keeps the winding.
Corners rotated(const Corners& t) {
  const auto first = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

/// Removes pairs of triangles with the same corners and opposite winding: a collapsed wall or ridge
/// thinner than a cell.
void remove_opposite_pairs(std::vector<Corners>& triangles) {
  const auto without_winding = [](const Corners& t) {
    return Corners{t[0], std::min(t[1], t[2]), std::max(t[1], t[2])};
  };
  std::sort(triangles.begin(), triangles.end(), [&](const Corners& a, const Corners& b) {
    const Corners ua = without_winding(a), ub = without_winding(b);
    return ua != ub ? ua < ub : a < b;
  });
  std::vector<Corners> kept;
  for (std::size_t begin = 0; begin < triangles.size();) {
    std::size_t end = begin;
    std::ptrdiff_t balance = 0;
    for (; end < triangles.size() &&
           without_winding(triangles[end]) == without_winding(triangles[begin]);
         ++end) {
      balance += triangles[end][1] < triangles[end][2] ? 1 : -1;
    }
    Corners one = without_winding(triangles[begin]);
    if (balance < 0) std::swap(one[1], one[2]);
    for (std::ptrdiff_t i = 0; i < std::abs(balance); ++i) kept.push_back(one);
    begin = end;
  }
  triangles = std::move(kept);
}

}  // namespace

TriangleMesh cluster_vertices(const TriangleMesh& mesh, double cell) {
  PCAVR_REQUIRE(cell > 0.0, cell);
  if (mesh.triangles.empty()) return {};
  const Clusters clusters = find_clusters(mesh, cell);
  TriangleMesh result;
  result.vertices = place_clusters(mesh, clusters, cell);
  for (const Corners& t : mesh.triangles) {
    const Corners moved{clusters.of_vertex[t[0]], clusters.of_vertex[t[1]],
                        clusters.of_vertex[t[2]]};
    if (moved[0] == moved[1] || moved[1] == moved[2] || moved[2] == moved[0]) continue;
    result.triangles.push_back(rotated(moved));
  }
  remove_opposite_pairs(result.triangles);
  return result;
}

}  // namespace pcavr::model
