// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/body_surface.hpp"

#include <cmath>

namespace pcavr {

Reach BodySurface::reach(const Pose& T_base_object, const Eigen::Vector3d& p_base_tip,
                         double tool_radius) const {
  const Eigen::Vector3f p_object = (T_base_object.inverse() * p_base_tip).cast<float>();
  const auto nearest = surface_.closest(p_object, static_cast<float>(kFarAway + tool_radius));
  if (!nearest) return {.clearance = kFarAway};
  const Eigen::Vector3d outward = (p_object - nearest->point).cast<double>();
  const Eigen::Vector3d normal = nearest->normal.cast<double>();
  // Near an edge the sign is subject to rounding; inside, the closest point lies on a face.
  const bool is_inside = outward.dot(normal) < -0.1 * outward.norm();
  const double distance = is_inside ? -outward.norm() : outward.norm();
  // On the surface itself the direction to it is undefined: use the triangle's normal.
  const bool is_apart = outward.norm() > 1e-5;
  const Eigen::Vector3d away = is_apart ? Eigen::Vector3d(outward / distance) : normal;
  return {.clearance = distance - tool_radius, .direction_base = T_base_object.rotation() * -away};
}

}  // namespace pcavr
