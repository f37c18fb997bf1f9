// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/body_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace pcavr::detail {
namespace {

/// [m] A ray starts this far below its face.
constexpr float kRayOffset = 1e-5F;

/// The minimum distance from a face straight through the body to the opposite one, at four points
/// of each triangle: 0 at a wedge.
double min_thickness_of(const TriangleMesh& mesh) {
  const SurfaceQuery query(mesh);
  float min_thickness = std::numeric_limits<float>::infinity();
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices[t[0]];
    const Eigen::Vector3f b = mesh.vertices[t[1]];
    const Eigen::Vector3f c = mesh.vertices[t[2]];
    const Eigen::Vector3f inward = -(b - a).cross(c - a).stableNormalized();
    const Eigen::Vector3f middle = (a + b + c) / 3.0F;
    for (const Eigen::Vector3f& corner : {middle, a, b, c}) {
      const Eigen::Vector3f start = 0.8F * corner + 0.2F * middle + kRayOffset * inward;
      const auto hit = query.cast(start, inward);
      if (hit) min_thickness = std::min(min_thickness, hit->distance + kRayOffset);
    }
  }
  return std::isfinite(min_thickness) ? static_cast<double>(min_thickness) : 0.0;
}

}  // namespace

BodyShape shape_of(const WorldBody& body) {
  const TriangleMesh& mesh = body.model.mesh_object;
  Eigen::AlignedBox3d box;
  double bottom = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const Eigen::Vector3d p = vertex.cast<double>();
    box.extend(p);
    bottom = std::min(bottom, (body.T_base_object * p).z());
  }
  // A box: (a^2 + b^2) / 12 about an axis; the mean of its three axes.
  const double gyration_radius = std::sqrt(box.sizes().squaredNorm() / 18.0);
  return {ClosestSurface(mesh, Pose()),
          body.model.centre_of_mass_object,
          box.center(),
          0.5 * box.diagonal().norm(),
          bottom,
          gyration_radius,
          min_thickness_of(mesh)};
}

}  // namespace pcavr::detail
