// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/body_standing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/turning/support.hpp"

#include "results/export/support_feet.hpp"

namespace pcavr::detail {
namespace {

constexpr double kThickness = 0.05;   // [m] of a support's box: deeper than any step of a body
constexpr double kFootRadius = 2e-3;  // [m] small, so that a foot rolls over no edge
/// Of the shape of a surface that nothing was identified of: even pressure.
LimitSurface shape_of(const BodyPhysics& physics) {
  return physics.limit_surface ? *physics.limit_surface
                               : ellipsoid_surface(1.0, physics.friction_radius);
}

}  // namespace

double lowest_height(const ExportedBody& body, const Eigen::Vector3d& up_base) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& vertex : body.mesh_object.vertices) {
    const Eigen::Vector3d point_object = vertex.cast<double>() + body.surface_offset_object;
    lowest = std::min(lowest, up_base.dot(body.T_base_object * point_object));
  }
  return lowest;
}

LoweredSupport support_box_of(const SupportPlane& plane, const std::vector<ExportedBody>& bodies) {
  double lowered = 0.0;
  for (const ExportedBody& body : bodies) {
    const auto& names = plane.objects;
    if (!body.is_movable || std::find(names.begin(), names.end(), body.name) == names.end())
      continue;
    const Plane& plane_base = plane.plane_base;
    const double distance = lowest_height(body, plane_base.normal) - plane_base.offset;
    lowered = std::max(lowered, kFootProtrusion - distance);
  }
  const Eigen::Vector3d normal = plane.plane_base.normal;
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : plane.outline_base) {
    box.extend(rotation.inverse() * corner);
  }
  const double top = plane.plane_base.offset - lowered;
  const Eigen::Vector3d centre(box.center().x(), box.center().y(), top - kThickness / 2.0);
  return {.box = {.name = {},
                  .T_base_box = Pose(rotation, rotation * centre),
                  .size = {box.sizes().x(), box.sizes().y(), kThickness}},
          .lowered = lowered};
}

void place_feet(const CadModel& model, const BodyPhysics& physics, const Plane& plane_base,
                ExportedBody& body, std::vector<ExportResidual>& residuals) {
  const LimitSurface surface = shape_of(physics);
  const std::vector<PlanarFoot> feet = fit_feet(surface);
  const Eigen::Rotation2Dd to_base(heading_of(body.T_base_object));
  const Eigen::Vector3d centre = body.T_base_object * model.centre_of_mass_object;
  const Pose T_object_base = body.T_base_object.inverse();
  for (const PlanarFoot& foot : feet) {
    const Eigen::Vector2d offset = to_base * foot.position;
    Eigen::Vector3d p_base = centre + Eigen::Vector3d(offset.x(), offset.y(), 0.0);
    p_base += (kFootRadius - plane_base.signed_distance(p_base)) * plane_base.normal;
    body.feet.push_back({.centre_object = T_object_base * p_base,
                         .radius = kFootRadius,
                         .friction = foot.friction * body.friction,
                         .load = 1.0 / static_cast<double>(feet.size())});
  }
  const double force = body.friction * body.inertia.mass * kStandardGravity;
  residuals.push_back({.object = body.name,
                       .what = "turning torque",
                       .wanted = force * turning_radius_of(surface),
                       .written = force * turning_radius_of(feet),
                       .unit = "N m",
                       .remark = "feet against the limit surface"});
  const FeetError error = error_of(feet, surface);
  residuals.push_back(
      {.object = body.name,
       .what = "friction wrench over all motions, rms",
       .wanted = force,
       .written = force * (1.0 + error.rms),
       .unit = "N",
       .remark = "feet against the limit surface; moments over the friction radius"});
}

}  // namespace pcavr::detail
