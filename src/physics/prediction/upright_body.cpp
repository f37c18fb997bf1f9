// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/upright_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/friction/point_push.hpp"
#include "pcavr/physics/friction/standing.hpp"
#include "pcavr/physics/friction/stribeck.hpp"

#include "physics/prediction/shifted_surface.hpp"

namespace pcavr::detail {
namespace {

/// Minimum friction [N]: without any, the limit surface would be degenerate.
constexpr double kMinFriction = 1e-6;
/// Minimum normal load on the support, as a share of the weight.
constexpr double kMinShare = 1e-3;
/// Maximum shift of the centre of pressure, over the friction radius: at the edge of the patch the
/// body would tip, which is not modelled.
constexpr double kMaxPressureShift = 1.0;
/// Mean square of the radius over the square of its mean, on a disc: (1/2) / (2/3)^2. A square has
/// 1.14, a rectangle of sides 2 and 1 1.19.
constexpr double kMeanSquareOfDisc = 1.125;
/// Over the static friction limit: a body that can move has moved on before the tip's force is so
/// large; one that is wedged lets the tip out on the side where that is closest.
constexpr double kMaxEntryForce = 2.0;
/// Minimum critical band below F_M, as a share of it: phases.csv's 0.9.
constexpr double kCriticalShare = 0.1;

double yaw_of(const Eigen::Matrix3d& rotation) {
  return std::atan2(rotation(1, 0) - rotation(0, 1), rotation(0, 0) + rotation(1, 1));
}

/// Transform from mesh axes to body axes at the start.
Pose to_body_axes(const Pose& T_base_object, const Eigen::Vector3d& centre_of_mass_object) {
  const Eigen::Vector3d centre = T_base_object * centre_of_mass_object;
  return Pose::from_translation({-centre.x(), -centre.y(), 0.0}) * T_base_object;
}

/// The force that keeps the body sliding without rotation, averaged over the directions.
double mean_force(const LimitSurface& surface) {
  constexpr int kDirections = 24;  // every 15 degrees: a quartic has no finer structure
  double sum = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kDirections;
    const Eigen::Vector3d twist(std::cos(angle), std::sin(angle), 0.0);
    sum += sliding_load(surface, twist).dot(twist);
  }
  return sum / kDirections;
}

/// Mean square radius of the pressure about the centre of mass [m^2].
double mean_square_radius(const BodyPhysics& physics) {
  return kMeanSquareOfDisc * physics.friction_radius * physics.friction_radius;
}

/// The friction radius about the `centre` [m] of a moved pressure, over that about the middle. A
/// pressure that grows linearly towards the centre has that much less of a second moment about it;
/// where it lifts off, that across the shift remains.
double moved_radius_share(const BodyPhysics& physics, const Eigen::Vector2d& centre) {
  return std::sqrt(std::max(0.5, 1.0 - centre.squaredNorm() / mean_square_radius(physics)));
}

PlanarFriction friction_of(const BodyPhysics& physics, double gyration_radius) {
  const FrictionParameters& f = physics.friction;
  const double static_limit = std::max(static_friction_limit(f), kMinFriction);
  const double coulomb = std::max(f.coulomb_force, kMinShare * static_limit);
  PlanarFriction friction;
  friction.mass = f.mass;
  friction.inertia = f.mass * gyration_radius * gyration_radius;
  if (physics.limit_surface) {
    friction.sliding = *physics.limit_surface;
    friction.sliding.force *= coulomb / mean_force(friction.sliding);
  } else {
    friction.sliding = ellipsoid_surface(coulomb, coulomb * physics.friction_radius);
  }
  friction.static_to_kinetic_ratio = static_limit / coulomb;
  friction.static_to_kinetic_std =
      std::max(f.limiting_force_std, kCriticalShare * static_limit) / coulomb;
  friction.viscous = f.viscous;
  friction.viscous_turning = f.viscous * mean_square_radius(physics);
  return friction;
}

}  // namespace

bool is_physical(const BodyPhysics& p) noexcept {
  const auto is_at_least = [](double value, double min) {
    return std::isfinite(value) && value >= min;
  };
  const double tiny = std::numeric_limits<double>::min();
  const bool has_surface = !p.limit_surface || (is_at_least(p.limit_surface->force, tiny) &&
                                                is_at_least(p.limit_surface->length, tiny));
  return pcavr::is_physical(p.friction) && is_at_least(p.contact.stiffness, tiny) &&
         is_at_least(p.contact.damping, 0.0) && is_at_least(p.contact.exponent, 1.0) &&
         is_at_least(p.stribeck_speed, 0.0) && is_at_least(p.tool_friction, 0.0) &&
         is_at_least(p.friction_radius, tiny) && has_surface;
}

UprightBody::UprightBody(const WorldBody& body, double gravity, double max_contact_force)
    : name_(body.model.name),
      is_movable_(body.is_movable),
      T_base_object_start_(body.T_base_object),
      centre_of_mass_object_(body.model.centre_of_mass_object),
      surface_(body.model.mesh_object, to_body_axes(T_base_object_start_, centre_of_mass_object_)),
      heading_(heading_of(T_base_object_start_)),
      gyration_radius_(pcavr::gyration_radius(body.model, T_base_object_start_)),
      gravity_(gravity),
      max_contact_force_(max_contact_force),
      lowest_(surface_.bounds().min().z()) {
  set_physics(body.physics);
}

void UprightBody::set_physics(const BodyPhysics& physics) {
  PCAVR_REQUIRE(is_physical(physics));
  physics_ = physics;
  friction_ = friction_of(physics, gyration_radius_);
  const double static_limit = friction_.static_to_kinetic_ratio * friction_.sliding.force;
  static_limit_depth_ = static_penetration(physics.contact, static_limit);
  max_entry_depth_ = static_penetration(
      physics.contact, is_movable_ ? kMaxEntryForce * static_limit : max_contact_force_);
  working_stiffness_ =
      contact_force(physics.contact, static_limit_depth_, 0.0, max_contact_force_).stiffness;
  sliding_depth_ = static_penetration(physics.contact, physics.friction.coulomb_force);
  critical_share_ = 1.0 - friction_.static_to_kinetic_std / friction_.static_to_kinetic_ratio;
}

Pose UprightBody::pose_of(const PlanarState& planar) const {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(planar.yaw, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond rotation = turn * T_base_object_start_.rotation();
  const Eigen::Vector3d start = T_base_object_start_ * centre_of_mass_object_;
  const Eigen::Vector3d centre(planar.position.x(), planar.position.y(), start.z());
  return {rotation, centre - rotation * centre_of_mass_object_};
}

PlanarState UprightBody::at_rest_in(const Pose& T_base_object, double yaw_near) const {
  const Eigen::Matrix3d turn =
      T_base_object.rotation_matrix() * T_base_object_start_.rotation_matrix().transpose();
  PlanarState planar;
  planar.position = (T_base_object * centre_of_mass_object_).head<2>();
  planar.yaw = yaw_near + std::remainder(yaw_of(turn) - yaw_near, 2.0 * std::numbers::pi);
  return planar;
}

double UprightBody::weight_share(double down) const noexcept {
  return std::max(kMinShare, 1.0 + down / (friction_.mass * gravity_));
}

PlanarFriction UprightBody::friction_under(const Eigen::Vector3d& force, const Eigen::Vector2d& arm,
                                           double height, double yaw) const noexcept {
  PlanarFriction friction = friction_;
  if (force.isZero(0.0)) return friction;
  const double normal_load = friction_.mass * gravity_ * weight_share(-force.z());
  Eigen::Vector2d centre = ((height - lowest_) * force.head<2>() - force.z() * arm) / normal_load;
  const double max_shift = kMaxPressureShift * physics_.friction_radius;
  const double shift = centre.norm();
  if (shift > max_shift) centre *= max_shift / shift;
  friction.sliding.length *= moved_radius_share(physics_, centre);
  friction.sliding = shifted(friction.sliding, Eigen::Rotation2Dd(-yaw - heading_) * centre);
  return friction;
}

double UprightBody::stribeck_factor(const Eigen::Vector3d& twist) const noexcept {
  if (!(physics_.stribeck_speed > 0.0)) return 1.0;
  const double speed = std::hypot(twist.x(), twist.y(), physics_.friction_radius * twist.z());
  return 1.0 +
         (friction_.static_to_kinetic_ratio - 1.0) * stribeck_share(speed, physics_.stribeck_speed);
}

PlanarStep UprightBody::step(const PlanarFriction& friction, const PlanarState& state,
                             const Eigen::Vector3d& load, double dt) const noexcept {
  PlanarState rotated = state;
  rotated.yaw += heading_;
  PlanarStep result = step_planar(friction, rotated, load, dt);
  // The difference, so that a body that did not rotate keeps its yaw to the last bit.
  result.state.yaw = state.yaw + (result.state.yaw - rotated.yaw);
  return result;
}

double UprightBody::level_of(const PlanarFriction& friction, double yaw,
                             const Eigen::Vector3d& load) const noexcept {
  Eigen::Vector3d load_body = load;
  load_body.head<2>() = Eigen::Rotation2Dd(-yaw - heading_) * load.head<2>();
  return level(friction.sliding, load_body);
}

Eigen::Vector3d UprightBody::slow_push_twist(const Eigen::Vector2d& arm,
                                             const Eigen::Vector2d& direction,
                                             double yaw) const noexcept {
  const Eigen::Rotation2Dd to_base(yaw + heading_);
  PointPush push;
  push.point = to_base.inverse() * arm;
  push.normal = to_base.inverse() * direction;
  push.friction_coefficient = physics_.tool_friction;
  push.velocity = push.normal;
  Eigen::Vector3d twist = push_at_point(friction_.sliding, push).twist;
  twist.head<2>() = to_base * twist.head<2>();
  return twist;
}

}  // namespace pcavr::detail
