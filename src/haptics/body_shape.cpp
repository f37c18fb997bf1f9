// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "haptics/body_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace pcavr::detail {
namespace {

/// [m] A ray starts this far below the face that it leaves.
constexpr float kBelow = 1e-5F;

/// The least way from a face straight through the body to the next one, at four places of each
/// triangle: 0 where it runs out to a wedge.
double thinnest_of(const TriangleMesh& mesh) {
  const SurfaceQuery query(mesh);
  float thinnest = std::numeric_limits<float>::infinity();
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices[t[0]];
    const Eigen::Vector3f b = mesh.vertices[t[1]];
    const Eigen::Vector3f c = mesh.vertices[t[2]];
    const Eigen::Vector3f inward = -(b - a).cross(c - a).stableNormalized();
    const Eigen::Vector3f middle = (a + b + c) / 3.0F;
    for (const Eigen::Vector3f& corner : {middle, a, b, c}) {
      const Eigen::Vector3f start = 0.8F * corner + 0.2F * middle + kBelow * inward;
      const auto hit = query.cast(start, inward);
      if (hit) thinnest = std::min(thinnest, hit->distance + kBelow);
    }
  }
  return std::isfinite(thinnest) ? static_cast<double>(thinnest) : 0.0;
}

}  // namespace

BodyShape shape_of(const WorldBody& body) {
  const TriangleMesh& mesh = body.model.mesh_object;
  Eigen::AlignedBox3d box;
  double foot = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const Eigen::Vector3d p = vertex.cast<double>();
    box.extend(p);
    foot = std::min(foot, (body.T_base_object * p).z());
  }
  // A box turns about its axes with a twelfth of two sides' squares; this is the mean of the three.
  const double gyration_radius = std::sqrt(box.sizes().squaredNorm() / 18.0);
  return {ClosestSurface(mesh, Pose()),
          body.model.centre_of_mass_object,
          box.center(),
          0.5 * box.diagonal().norm(),
          foot,
          gyration_radius,
          thinnest_of(mesh)};
}

}  // namespace pcavr::detail
