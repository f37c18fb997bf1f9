// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/prediction/closest_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace pcavr::detail {
namespace {

constexpr std::uint32_t kLeafSize = 4;  // a few triangles cost less than another box
/// Cosine of 25 degrees between normals of one face: neighbouring facets of a curved one are less
/// apart, faces that meet in an edge are more.
constexpr double kEnteredFace = 0.9;
constexpr double kBehind = 1.0 - 1e-6;  // cosine, within rounding: straight behind a face

using Corners = std::array<Eigen::Vector3d, 3>;

/// A point on a triangle, and its feature: face 0, edges 01 12 20 as 1 2 3, corners as 4 5 6.
struct PointOnTriangle {
  Eigen::Vector3d point;
  std::size_t feature = 0;
};

PointOnTriangle on_edge(const Eigen::Vector3d& p, const Corners& corner, std::size_t i) noexcept {
  const std::size_t j = (i + 1) % 3;
  const Eigen::Vector3d edge = corner[j] - corner[i];
  const double length2 = edge.squaredNorm();
  const double share = length2 > 0.0 ? (p - corner[i]).dot(edge) / length2 : 0.0;
  if (share <= 0.0) return {corner[i], 4 + i};
  if (share >= 1.0) return {corner[j], 4 + j};
  return {corner[i] + share * edge, 1 + i};
}

/// `inward`: as in Triangle.
PointOnTriangle closest_on(const Eigen::Vector3d& p, const Corners& corner,
                           const Eigen::Vector3d& unit_normal, const Corners& inward) noexcept {
  bool is_over_face = !unit_normal.isZero(0.0);
  for (std::size_t i = 0; i < 3 && is_over_face; ++i) {
    is_over_face = inward[i].dot(p - corner[i]) >= 0.0;
  }
  if (is_over_face) return {p - unit_normal.dot(p - corner[0]) * unit_normal, 0};
  PointOnTriangle best = on_edge(p, corner, 0);
  for (std::size_t i = 1; i < 3; ++i) {
    const PointOnTriangle there = on_edge(p, corner, i);
    if ((p - there.point).squaredNorm() < (p - best.point).squaredNorm()) best = there;
  }
  return best;
}

/// Whether the triangle's plane, and so the triangle, is no closer than this squared distance.
bool is_beyond(const Eigen::Vector3d& p, const Corners& corner, const Eigen::Vector3d& unit_normal,
               double distance2) noexcept {
  const double to_plane = unit_normal.dot(p - corner[0]);
  return to_plane * to_plane >= distance2;
}

double angle_at(const Corners& corner, std::size_t i) noexcept {
  const Eigen::Vector3d a = corner[(i + 1) % 3] - corner[i];
  const Eigen::Vector3d b = corner[(i + 2) % 3] - corner[i];
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Whether no vertex lies in front of any triangle. False also for meshes that are too large to
/// try.
bool is_convex(const TriangleMesh& mesh) noexcept {
  constexpr double kMaxTests = 1e8;   // 0.1 s
  constexpr float kRounding = 1e-6F;  // of single precision, relative to the mesh's size
  const auto tests =
      static_cast<double>(mesh.triangles.size()) * static_cast<double>(mesh.vertices.size());
  if (mesh.triangles.empty() || tests > kMaxTests) return false;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  const float tolerance = kRounding * box.diagonal().norm();
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& indices) {
    const Eigen::Vector3f& a = mesh.vertices[indices[0]];
    const Eigen::Vector3f normal =
        (mesh.vertices[indices[1]] - a).cross(mesh.vertices[indices[2]] - a).stableNormalized();
    return std::none_of(
        mesh.vertices.begin(), mesh.vertices.end(),
        [&](const Eigen::Vector3f& vertex) { return normal.dot(vertex - a) > tolerance; });
  });
}

/// Whether `p` can have come in through a triangle: it is behind it.
bool is_entered(const Eigen::Vector3d& p, const Eigen::Vector3d& corner,
                const Eigen::Vector3d& unit_normal, const Eigen::Vector3d& entry_normal) noexcept {
  return unit_normal.dot(entry_normal) > kEnteredFace && unit_normal.dot(p - corner) < 0.0;
}

}  // namespace

struct ClosestSurface::Candidate {
  double distance2 = 0.0;
  const Triangle* triangle = nullptr;
  PointOnTriangle on = {Eigen::Vector3d::Zero(), 0};
};

ClosestSurface::ClosestSurface(const TriangleMesh& mesh, const Pose& T_frame_mesh)
    : is_convex_(is_convex(mesh)) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Edge, Eigen::Vector3d> edge_normals;
  std::vector<Eigen::Vector3d> corner_normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  const auto key = [](std::uint32_t a, std::uint32_t b) -> Edge {
    return {std::min(a, b), std::max(a, b)};
  };
  triangles_.reserve(mesh.triangles.size());
  for (const auto& indices : mesh.triangles) {
    Triangle& triangle = triangles_.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.corner[i] = T_frame_mesh * mesh.vertices[indices[i]].cast<double>();
    }
    const auto& c = triangle.corner;
    triangle.normal[0] = (c[1] - c[0]).cross(c[2] - c[0]).stableNormalized();
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge edge = key(indices[i], indices[(i + 1) % 3]);
      edge_normals.try_emplace(edge, Eigen::Vector3d::Zero()).first->second += triangle.normal[0];
      corner_normals[indices[i]] += angle_at(c, i) * triangle.normal[0];
      triangle.inward[i] = triangle.normal[0].cross(c[(i + 1) % 3] - c[i]);
    }
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto& indices = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      triangles_[t].normal[1 + i] =
          edge_normals.at(key(indices[i], indices[(i + 1) % 3])).stableNormalized();
      triangles_[t].normal[4 + i] = corner_normals[indices[i]].stableNormalized();
    }
  }
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(triangles_.size()));
}

void ClosestSurface::build(std::uint32_t node, std::uint32_t first, std::uint32_t count) {
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox3d middles;
  const auto middle_of = [](const Triangle& t) -> Eigen::Vector3d {
    return (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0;
  };
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const Eigen::Vector3d& corner : triangles_[i].corner) box.extend(corner);
    middles.extend(middle_of(triangles_[i]));
  }
  nodes_[node] = {box, first, count};
  if (count <= kLeafSize) return;
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const auto begin = triangles_.begin() + first;
  std::stable_sort(begin, begin + count, [&](const Triangle& a, const Triangle& b) {
    return middle_of(a)[axis] < middle_of(b)[axis];
  });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_[node].count = 0;
  nodes_.resize(nodes_.size() + 2);
  build(children, first, count / 2);
  build(children + 1, first + count / 2, count - count / 2);
}

void ClosestSurface::search(std::uint32_t index, const Eigen::Vector3d& p,
                            const Eigen::Vector3d* entry_normal, Candidate& best) const noexcept {
  const Node& node = nodes_[index];
  if (node.count == 0) {
    const double left = nodes_[node.first].box.squaredExteriorDistance(p);
    const double right = nodes_[node.first + 1].box.squaredExteriorDistance(p);
    const std::uint32_t near = node.first + (right < left ? 1 : 0);
    const std::uint32_t far = node.first + (right < left ? 0 : 1);
    if (std::min(left, right) < best.distance2) search(near, p, entry_normal, best);
    if (std::max(left, right) < best.distance2) search(far, p, entry_normal, best);
    return;
  }
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    const Triangle& triangle = triangles_[i];
    if (entry_normal != nullptr &&
        !is_entered(p, triangle.corner[0], triangle.normal[0], *entry_normal))
      continue;
    if (is_beyond(p, triangle.corner, triangle.normal[0], best.distance2)) continue;
    const PointOnTriangle on = closest_on(p, triangle.corner, triangle.normal[0], triangle.inward);
    const double distance2 = (p - on.point).squaredNorm();
    if (distance2 < best.distance2) best = {distance2, &triangle, on};
  }
}

/// The triangles within reach of a point.
struct ClosestSurface::Neighbours {
  static constexpr std::size_t kMax = 32;  // more only of a surface finer than the reach
  std::array<Candidate, kMax> all;
  std::size_t count = 0;
  bool is_complete = true;

  /// Whether no triangle that meets at the candidate's point has a closer one.
  [[nodiscard]] bool is_minimum(const Candidate& candidate) const noexcept {
    constexpr double kSame2 = 1e-18;  // [m^2] of one point, computed twice
    const Eigen::Vector3d& point = candidate.on.point;
    return std::none_of(
        all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), [&](const Candidate& other) {
          if ((other.on.point - point).squaredNorm() <= kSame2) return false;
          const auto& triangle = *other.triangle;
          const Eigen::Vector3d on_other =
              closest_on(point, triangle.corner, triangle.normal[0], triangle.inward).point;
          return (on_other - point).squaredNorm() <= kSame2;
        });
  }
};

void ClosestSurface::gather(std::uint32_t index, const Eigen::Vector3d& p, double reach,
                            Neighbours& near) const noexcept {
  const Node& node = nodes_[index];
  if (node.box.squaredExteriorDistance(p) >= reach * reach) return;
  if (node.count == 0) {
    gather(node.first, p, reach, near);
    gather(node.first + 1, p, reach, near);
    return;
  }
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    const Triangle& triangle = triangles_[i];
    if (is_beyond(p, triangle.corner, triangle.normal[0], reach * reach)) continue;
    const PointOnTriangle on = closest_on(p, triangle.corner, triangle.normal[0], triangle.inward);
    const double distance2 = (p - on.point).squaredNorm();
    if (distance2 >= reach * reach) continue;
    near.is_complete = near.count < Neighbours::kMax;
    if (!near.is_complete) return;
    near.all[near.count++] = {distance2, &triangle, on};
  }
}

std::size_t ClosestSurface::local_minima(const Eigen::Vector3d& p, double reach,
                                         const Result& closest,
                                         std::span<Result> found) const noexcept {
  constexpr double kSameDirection = 0.866;  // cosine of 30 degrees
  if (found.empty()) return 0;
  std::size_t count = 0;
  found[count++] = closest;
  if (is_convex_ || !(closest.distance > 0.0)) return count;
  Neighbours near;
  gather(0, p, reach, near);
  if (!near.is_complete) return count;
  std::sort(near.all.begin(), near.all.begin() + static_cast<std::ptrdiff_t>(near.count),
            [](const Candidate& a, const Candidate& b) { return a.distance2 < b.distance2; });
  for (std::size_t i = 0; i < near.count && count < found.size(); ++i) {
    const Candidate& candidate = near.all[i];
    const Eigen::Vector3d away = p - candidate.on.point;
    const double distance = std::sqrt(candidate.distance2);
    if (!(away.dot(candidate.triangle->normal[candidate.on.feature]) > 0.0)) continue;
    const Eigen::Vector3d normal = away / distance;
    const bool is_known =
        std::any_of(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](const Result& known) { return known.normal.dot(normal) > kSameDirection; });
    if (is_known || !near.is_minimum(candidate)) continue;
    found[count++] = {distance, candidate.on.point, normal};
  }
  return count;
}

std::optional<ClosestSurface::Result> ClosestSurface::closest(const Eigen::Vector3d& p,
                                                              double reach) const noexcept {
  const double outside2 = bounds().squaredExteriorDistance(p);
  if (!(outside2 < reach * reach)) return std::nullopt;
  // Inside the box, the inside of the body may be further from its surface than `reach`.
  Candidate best{
      outside2 > 0.0 ? reach * reach : std::numeric_limits<double>::infinity(), nullptr, {}};
  search(0, p, nullptr, best);
  if (best.triangle == nullptr) return std::nullopt;
  const Eigen::Vector3d& outward = best.triangle->normal[best.on.feature];
  const Eigen::Vector3d away = p - best.on.point;
  const double size = std::sqrt(best.distance2);
  const double sign = away.dot(outward) >= 0.0 ? 1.0 : -1.0;
  if (sign > 0.0 && size > reach) return std::nullopt;
  // Very close to the surface the difference is rounding error: there its normal is more accurate.
  const Eigen::Vector3d normal = size > 1e-9 ? Eigen::Vector3d(sign / size * away) : outward;
  return Result{sign * size, best.on.point, normal};
}

std::optional<ClosestSurface::Result> ClosestSurface::closest(
    const Eigen::Vector3d& p, double reach, const Eigen::Vector3d& entry_normal) const noexcept {
  const std::optional<Result> nearest = closest(p, reach);
  if (!nearest || !(nearest->distance < 0.0) || entry_normal.isZero(0.0)) return nearest;
  if (nearest->normal.dot(entry_normal) > kEnteredFace) return nearest;
  Candidate best{std::numeric_limits<double>::infinity(), nullptr, {}};
  search(0, p, &entry_normal, best);
  if (best.triangle == nullptr) return nearest;
  const double distance = std::sqrt(best.distance2);
  const Eigen::Vector3d& normal = best.triangle->normal[0];
  // Otherwise the closest point is on the face's edge, and `p` beside it.
  if (!((best.on.point - p).dot(normal) > kBehind * distance)) return nearest;
  return Result{-distance, best.on.point, normal};
}

}  // namespace pcavr::detail
