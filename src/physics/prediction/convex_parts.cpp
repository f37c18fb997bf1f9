// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/convex_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <BulletCollision/CollisionShapes/btConvexPolyhedron.h>

namespace pcavr::detail {
namespace {

constexpr std::size_t kMaxCuts = 12;     // tried along each axis; each costs two hulls
constexpr std::size_t kMaxCorners = 64;  // of a hull: clipping takes time in proportion

using Triangle = std::array<Eigen::Vector3d, 3>;
using Surface = std::vector<Triangle>;

btVector3 to_bullet(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

/// The hull with its faces; null where the points lie in a plane.
std::unique_ptr<btConvexHullShape> hull_of(const std::vector<Eigen::Vector3d>& points) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Eigen::Vector3d& p : points) hull->addPoint(to_bullet(p), false);
  hull->setMargin(0.0);
  hull->recalcLocalAabb();
  if (points.size() < 4 || !hull->initializePolyhedralFeatures()) return nullptr;
  if (hull->getConvexPolyhedron()->m_faces.size() < 4) return nullptr;
  return hull;
}

/// Limits the number of points for speed: the extreme ones along evenly distributed directions.
std::vector<Eigen::Vector3d> extreme_points(const Surface& surface) {
  std::vector<Eigen::Vector3d> points;
  for (const Triangle& t : surface) points.insert(points.end(), t.begin(), t.end());
  const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() <= kMaxCorners) return points;
  std::vector<Eigen::Vector3d> extremes;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < kMaxCorners; ++i) {  // a Fibonacci spiral over the sphere
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / kMaxCorners;
    const double angle = golden * static_cast<double>(i);
    const double radius = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d direction(radius * std::cos(angle), radius * std::sin(angle), z);
    extremes.push_back(*std::max_element(
        points.begin(), points.end(),
        [&](const auto& a, const auto& b) { return direction.dot(a) < direction.dot(b); }));
  }
  std::sort(extremes.begin(), extremes.end(), less);
  extremes.erase(std::unique(extremes.begin(), extremes.end()), extremes.end());
  return extremes;
}

/// Maximum depth of the surface under its hull [m].
double concavity_of(const Surface& surface, const btConvexHullShape& hull) {
  double max_depth = 0.0;
  for (const Triangle& t : surface) {
    const Eigen::Vector3d middle = (t[0] + t[1] + t[2]) / 3.0;
    for (const Eigen::Vector3d& p : {t[0], t[1], t[2], middle}) {
      double depth = std::numeric_limits<double>::infinity();
      const btConvexPolyhedron& polyhedron = *hull.getConvexPolyhedron();
      for (int f = 0; f < polyhedron.m_faces.size(); ++f) {
        const btScalar* plane = polyhedron.m_faces[f].m_plane;
        const Eigen::Vector3d normal(plane[0], plane[1], plane[2]);
        depth = std::min(depth, -(normal.dot(p) + plane[3]));
      }
      max_depth = std::max(max_depth, depth);
    }
  }
  return max_depth;
}

struct Part {
  Surface surface;
  std::unique_ptr<btConvexHullShape> hull;
  double concavity = 0.0;
};

Part make_part(Surface surface) {
  Part part;
  part.hull = hull_of(extreme_points(surface));
  if (part.hull) part.concavity = concavity_of(surface, *part.hull);
  part.surface = std::move(surface);
  return part;
}

/// The part on one side of a plane across an axis: `side` 1 beyond it, -1 before it. A face in the
/// plane belongs to the side of its solid.
Surface side_of(const Surface& surface, Eigen::Index axis, double at, double side) {
  Surface result;
  for (const Triangle& t : surface) {
    const bool is_in_plane = t[0][axis] == at && t[1][axis] == at && t[2][axis] == at;
    if (is_in_plane && side * (t[1] - t[0]).cross(t[2] - t[0])[axis] > 0.0) continue;
    std::vector<Eigen::Vector3d> polygon;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d& a = t[i];
      const Eigen::Vector3d& b = t[(i + 1) % 3];
      const double da = side * (a[axis] - at);
      const double db = side * (b[axis] - at);
      if (da >= 0.0) polygon.push_back(a);
      if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
        polygon.emplace_back(a + da / (da - db) * (b - a));
      }
    }
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      result.push_back({polygon[0], polygon[i - 1], polygon[i]});
    }
  }
  return result;
}

/// Coordinates at which an axis may be cut: the surface's own vertices, subsampled where many.
std::vector<double> cuts_along(const Surface& surface, Eigen::Index axis, double tolerance) {
  std::vector<double> heights;
  for (const Triangle& t : surface) {
    for (const Eigen::Vector3d& p : t) heights.push_back(p[axis]);
  }
  std::sort(heights.begin(), heights.end());
  const double low = heights.front() + tolerance;
  const double high = heights.back() - tolerance;
  std::vector<double> cuts;
  for (const double height : heights) {
    if (height <= low || height >= high) continue;
    if (cuts.empty() || height > cuts.back() + 0.25 * tolerance) cuts.push_back(height);
  }
  if (cuts.size() <= kMaxCuts) return cuts;
  std::vector<double> some;
  for (std::size_t i = 0; i < kMaxCuts; ++i) {
    some.push_back(cuts[(2 * i + 1) * cuts.size() / (2 * kMaxCuts)]);
  }
  return some;
}

/// The cut that minimises the concavity of both sides together; empty where none reduces it.
std::vector<Part> cut(const Part& part, double tolerance) {
  std::vector<Part> best;
  double min_concavity = 1.999 * part.concavity;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const double at : cuts_along(part.surface, axis, tolerance)) {
      Part before = make_part(side_of(part.surface, axis, at, -1.0));
      Part beyond = make_part(side_of(part.surface, axis, at, 1.0));
      if (!before.hull && !beyond.hull) continue;
      const double sum = before.concavity + beyond.concavity;
      if (!(sum < min_concavity - 1e-9)) continue;
      min_concavity = sum;
      best.clear();
      for (Part* side :
           {&before, &beyond}) {  // a side without volume is that of a face in the plane
        if (side->hull) best.push_back(std::move(*side));
      }
    }
  }
  return best;
}

}  // namespace

std::vector<std::unique_ptr<btConvexHullShape>> convex_parts(const TriangleMesh& mesh,
                                                             const Pose& T_frame_mesh,
                                                             double relative_tolerance,
                                                             std::size_t max_parts) {
  Surface whole;
  for (const auto& t : mesh.triangles) {
    whole.push_back({mesh.vertices[t[0]].cast<double>(), mesh.vertices[t[1]].cast<double>(),
                     mesh.vertices[t[2]].cast<double>()});
  }
  const double tolerance =
      relative_tolerance * static_cast<double>(bounds(mesh.vertices).diagonal().norm());
  std::vector<Part> parts;
  parts.push_back(make_part(std::move(whole)));
  for (std::size_t i = 0; i < parts.size();) {
    if (parts[i].concavity <= tolerance || parts.size() >= max_parts) {
      ++i;
      continue;
    }
    std::vector<Part> sides = cut(parts[i], tolerance);
    if (sides.empty()) {
      ++i;
      continue;
    }
    parts[i] = std::move(sides[0]);
    if (sides.size() == 2) parts.push_back(std::move(sides[1]));
  }
  // Cut along the mesh's own axes, where a CAD body's faces lie; then transformed.
  std::vector<std::unique_ptr<btConvexHullShape>> hulls;
  for (const Part& part : parts) {
    std::vector<Eigen::Vector3d> corners = extreme_points(part.surface);
    for (Eigen::Vector3d& corner : corners) corner = T_frame_mesh * corner;
    if (auto hull = hull_of(corners)) hulls.push_back(std::move(hull));
  }
  return hulls;
}

}  // namespace pcavr::detail
