// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_upright.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// A table's slope, and the noise of its scan [rad].
constexpr double kMaxSlope = 10.0 * std::numbers::pi / 180.0;
/// The surface around an object, in multiples of its radius: less shows only what it stands on.
constexpr double kReach = 2.0;
/// Share of the surface around the objects that one direction must have to be what they stand on.
constexpr double kMinShare = 0.5;
/// Triangles that are compared with each other: their number does not change the direction.
constexpr std::size_t kMaxTriangles = 500;

struct Sphere {
  Eigen::Vector3d centre;
  double radius = 0.0;  ///< [m]
};

/// The parts of a surface around the objects that face one of them, as what they stand on does:
/// their normals, as long as their areas [m^2].
std::vector<Eigen::Vector3d> surface_near(const TriangleMesh& mesh,
                                          const std::vector<SceneObject>& objects) {
  std::vector<Sphere> spheres;
  for (const SceneObject& object : objects) {
    if (object.evidence == kNotSeen || !object.is_movable) continue;
    const Eigen::AlignedBox3d box = bounds(object.model.mesh_object.vertices).cast<double>();
    spheres.push_back(
        {object.T_base_object * Eigen::Vector3d(box.center()), kReach * 0.5 * box.sizes().norm()});
  }
  std::vector<Eigen::Vector3d> parts;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d p = mesh.vertices[a].cast<double>();
    const Eigen::Vector3d normal =
        0.5 * (mesh.vertices[b].cast<double>() - p).cross(mesh.vertices[c].cast<double>() - p);
    if (std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& sphere) {
          const Eigen::Vector3d to_centre = sphere.centre - p;
          return to_centre.norm() < sphere.radius && normal.dot(to_centre) > 0.0;
        })) {
      parts.push_back(normal);
    }
  }
  return parts;
}

/// The direction that most of the surface has; nothing where none has.
std::optional<Eigen::Vector3d> main_normal(const std::vector<Eigen::Vector3d>& parts) {
  const std::size_t stride = 1 + parts.size() / kMaxTriangles;
  const double min_cosine = std::cos(kMaxSlope);
  double area = 0.0;
  double best_area = 0.0;
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < parts.size(); i += stride) {
    area += parts[i].norm();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double sum_area = 0.0;
    for (std::size_t j = 0; j < parts.size(); j += stride) {
      if (parts[i].dot(parts[j]) < min_cosine * parts[i].norm() * parts[j].norm()) continue;
      sum += parts[j];
      sum_area += parts[j].norm();
    }
    if (sum_area <= best_area) continue;
    best_area = sum_area;
    best = sum.normalized();
  }
  if (!(best_area > kMinShare * area)) return std::nullopt;
  return best;
}

double slope_of(const Eigen::Vector3d& normal) {
  return std::acos(std::clamp(normal.z(), -1.0, 1.0));
}

/// The only base tag's index; nothing where there are none, or several.
std::optional<std::size_t> only_base_tag(const Manifest& manifest) {
  std::optional<std::size_t> only;
  for (std::size_t i = 0; i < manifest.markers.size(); ++i) {
    if (manifest.markers[i].role != MarkerRole::base) continue;
    if (only) return std::nullopt;
    only = i;
  }
  return only;
}

}  // namespace

std::optional<ConsistencyFinding> check_upright(const Manifest& manifest, const Scene& scene) {
  const bool is_supported =
      std::any_of(scene.support_planes.begin(), scene.support_planes.end(),
                  [](const SupportPlane& plane) { return !plane.objects.empty(); });
  if (is_supported) return std::nullopt;
  const auto normal = main_normal(surface_near(scene.mesh_base, scene.objects));
  if (!normal || slope_of(*normal) <= kMaxSlope) return std::nullopt;
  const auto tag = only_base_tag(manifest);
  ConsistencyFinding finding{
      .file = "recording.yaml",
      .place = tag ? key_of_marker(*tag) + ".pose" : "markers",
      .message = fmt::format("no object stands on a horizontal surface: the one around them is "
                             "inclined by {} to base's x-y plane",
                             degrees(slope_of(*normal))),
      .hint = "check the base tags' poses and sizes: base's z axis is up, q is [qx, qy, qz, qw]"};
  if (!tag) return finding;
  const Eigen::Quaterniond q = manifest.markers[*tag].T_parent_marker.rotation();
  const Eigen::Quaterniond w_first(q.x(), q.y(), q.z(), q.w());
  if (slope_of(w_first * (q.conjugate() * *normal)) > kMaxSlope) return finding;
  finding.severity = FindingSeverity::contradiction;
  finding.hint =
      "read as w x y z its quaternion makes the surface horizontal: write q as "
      "[qx, qy, qz, qw]";
  return finding;
}

}  // namespace pcavr
