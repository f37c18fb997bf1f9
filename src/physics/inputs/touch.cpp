// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/touch.hpp"

namespace pcavr {
namespace {

/// Smallest distance from the tip's centre, as a share of its radius, at which the direction to the
/// surface is used: penetration and pose errors together are less than the rest.
constexpr double kMinDistance = 0.3;
/// Near an edge the sign of a distance is subject to rounding; inside, the closest point lies on a
/// face, and the direction to it is along that face's normal.
constexpr double kInsideCosine = -0.1;

}  // namespace

Touch BodySurface::touch(const Pose& T_base_object, const Eigen::Vector3d& p_base_tip,
                         double tool_radius) const {
  const Eigen::Vector3d p_object = T_base_object.inverse() * p_base_tip;
  const auto closest =
      surface_.closest(p_object.cast<float>(), static_cast<float>(kTouchSearchRadius));
  if (!closest) return {};
  const Eigen::Vector3d outward = p_object - closest->point.cast<double>();
  const Eigen::Vector3d normal = closest->normal.cast<double>();
  const double distance = outward.norm();
  const bool is_inside = outward.dot(normal) < kInsideCosine * distance;
  // Where the tip's centre is close to the surface, or behind it, the direction to it is
  // ill-defined: the normal is used.
  const bool has_direction = !is_inside && distance > kMinDistance * tool_radius;
  const Eigen::Vector3d inward =
      has_direction ? Eigen::Vector3d(-outward / distance) : Eigen::Vector3d(-normal);
  return {(is_inside ? -distance : distance) - tool_radius, normal,
          T_base_object.rotation() * inward};
}

std::optional<TouchedBody> touched_body(std::span<const Touch> touches,
                                        const InputOptions& options) {
  if (touches.empty()) return std::nullopt;
  TouchedBody nearest;
  for (std::size_t i = 1; i < touches.size(); ++i) {
    if (touches[i].gap < touches[nearest.body].gap) nearest.body = i;
  }
  const double gap = touches[nearest.body].gap;
  if (!(gap <= options.max_touch_gap)) return std::nullopt;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    nearest.is_ambiguous |= i != nearest.body && touches[i].gap - gap < options.min_gap_difference;
  }
  return nearest;
}

}  // namespace pcavr
