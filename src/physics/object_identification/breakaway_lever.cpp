// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/object_identification/breakaway_lever.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>

#include <Eigen/Core>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/physics/turning/support.hpp"

namespace pcavr {
namespace {

constexpr double kForceHalfWidth = 0.020;  // [s] of the force's mean

}  // namespace

double lever_at(double t, const Contact& push, const BodyMotion& body, const PathView& tip,
                double tool_radius) {
  if (!push.breakaway.is_found || body.tracked.empty()) return 0.0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < push.t.size(); ++i) {
    if (std::abs(push.t[i] - t) <= kForceHalfWidth) force += push.force_base[i];
  }
  const double size = force.head<2>().norm();
  if (!(size > 0.0)) return 0.0;
  const Pose T_base_object = pose_at(body.tracked, t);
  const Eigen::Vector3d arm = tip.at(t) -
                              tool_radius * (T_base_object.rotation() * push.normal_object) -
                              T_base_object * body.model.centre_of_mass_object;
  return (arm.x() * force.y() - arm.y() * force.x()) / size;
}

double yield_instant(const Contact& contact, double coulomb) {
  const double half_width = std::max(kForceHalfWidth, 3.0 * mean_interval(contact.t));
  const auto peak = std::lower_bound(contact.t.begin(), contact.t.end(), contact.breakaway.t);
  double yields = contact.breakaway.t;
  for (auto i = peak; i != contact.t.begin(); --i) {
    const double t = *std::prev(i);
    const SmoothedSample force = smooth_at(contact.t, contact.force, t, half_width);
    if (!force.is_valid || force.value < coulomb) break;
    yields = t;
  }
  return yields;
}

double turning_at_breakaway(const Contact& push, const BodyMotion& body) {
  constexpr double kRest = 0.3;      // [s] before the peak: averages the noise of tracking
  constexpr double kTravel = 0.005;  // [m] ten times the noise of tracking and more
  const double at = push.breakaway.t;
  if (!push.breakaway.is_found) return 0.0;
  Eigen::Vector3d rest = Eigen::Vector3d::Zero();  // place, and heading beside the first one
  double count = 0.0, products = 0.0, squares = 0.0, first = 0.0;
  for (const TrackedPose& pose : body.tracked) {
    if (pose.t < at - kRest) continue;
    if (pose.t > push.end) break;
    const Eigen::Vector3d centre = pose.T_base_object * body.model.centre_of_mass_object;
    const double heading = heading_of(pose.T_base_object);
    if (count == 0.0) first = heading;
    const Eigen::Vector3d place(centre.x(), centre.y(),
                                std::remainder(heading - first, 2.0 * std::numbers::pi));
    if (pose.t <= at || count == 0.0) {
      rest += place;
      count += 1.0;
      continue;
    }
    const Eigen::Vector3d moved = place - rest / count;
    const double travel = moved.head<2>().norm();
    if (travel > kTravel) break;
    products += travel * moved.z();
    squares += travel * travel;
  }
  return squares > 0.0 ? std::abs(products) / squares : 0.0;
}

IdentifiedParameter support_radius(const BodyMotion& body, const ObjectParameters& known,
                                   const FrictionPriors& priors) {
  double radius = 0.0, std = 0.0;
  if (known.friction_radius) {
    radius = known.friction_radius->value;
    std = known.friction_radius->std.value_or(0.0);
  } else if (!body.tracked.empty()) {
    radius = Support(body.model, body.tracked.front().T_base_object).radius();
    std = priors.support_size_share * radius;
  }
  return {radius, std, radius > 0.0};
}

LimitOfMotion limit_with_moment(const LimitOfMotion& limit, double lever,
                                const IdentifiedParameter& radius) {
  PCAVR_REQUIRE(radius.value > 0.0, radius.value);
  const double ratio = lever / radius.value;
  const double factor = std::hypot(1.0, ratio);
  const double by_radius = ratio * ratio / (factor * factor) * radius.std / radius.value;
  LimitOfMotion found = limit;
  found.limit.value *= factor;
  found.limit.std *= factor;
  found.shared_std = std::hypot(factor * limit.shared_std, found.limit.value * by_radius);
  return found;
}

}  // namespace pcavr
