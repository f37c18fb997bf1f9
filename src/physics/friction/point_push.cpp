// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/point_push.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace pcavr {
namespace {

/// Angle from a to b [rad], in (-pi, pi].
double angle_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b) noexcept {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

/// The quasi-static response to a unit force at an angle from the normal.
struct Response {
  Eigen::Vector3d wrench;
  Eigen::Vector3d twist;           // of any length
  Eigen::Vector2d point_velocity;  // likewise
  double heading;                  // of the point's velocity, from the normal [rad]

  Response(const LimitSurface& surface, const PointPush& push, double angle) noexcept {
    const Eigen::Vector2d force = Eigen::Rotation2Dd(angle) * push.normal.normalized();
    wrench = wrench_of(force, push.point);
    twist = sliding_direction(surface, wrench);
    point_velocity = velocity_of(push.point, twist);
    // The two are less than a right angle apart, so the difference does not wrap.
    heading = angle + angle_between(force, point_velocity);
  }
};

PushMotion motion_of(const LimitSurface& surface, const Response& response, double speed,
                     PushMode mode) noexcept {
  return {mode, response.twist * speed, response.wrench / level(surface, response.wrench)};
}

}  // namespace

Eigen::Vector3d wrench_of(const Eigen::Vector2d& force, const Eigen::Vector2d& point) noexcept {
  return {force.x(), force.y(), point.x() * force.y() - point.y() * force.x()};
}

Eigen::Vector2d velocity_of(const Eigen::Vector2d& point, const Eigen::Vector3d& twist) noexcept {
  return {twist.x() - twist.z() * point.y(), twist.y() + twist.z() * point.x()};
}

PushMotion push_at_point(const LimitSurface& surface, const PointPush& push) noexcept {
  const double approach = push.normal.normalized().dot(push.velocity);
  if (!(approach > 0.0)) return {};
  const double heading = angle_between(push.normal, push.velocity);
  double low = -std::atan(push.friction_coefficient);
  double high = -low;
  for (const double edge : {low, high}) {
    const Response at_edge(surface, push, edge);
    const bool slips = edge == low ? heading < at_edge.heading : heading > at_edge.heading;
    if (!slips) continue;
    const double speed = approach / push.normal.normalized().dot(at_edge.point_velocity);
    return motion_of(surface, at_edge, speed, PushMode::slipping);
  }
  for (int i = 0; i < 50; ++i) {  // bisection, to the last bit of an angle
    const double middle = 0.5 * (low + high);
    (Response(surface, push, middle).heading < heading ? low : high) = middle;
  }
  const Response response(surface, push, 0.5 * (low + high));
  const double speed = push.velocity.norm() / response.point_velocity.norm();
  return motion_of(surface, response, speed, PushMode::sticking);
}

}  // namespace pcavr
