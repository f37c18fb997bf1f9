// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/plant_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pcavr/base/core/gravity.hpp"

namespace pcavr::simulation {
namespace {

/// Sleeping threshold: a body that is not touched and slower than this rests until it is touched
/// again [m/s].
constexpr double kRestingSpeed = 1e-7;

/// Damping ratio of a servo drive: well damped, with negligible overshoot.
constexpr double kArmDampingRatio = 0.8;

double yaw_of(const Pose& T_base_object) {
  const Eigen::Vector3d x = T_base_object.rotation() * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

struct MassDistribution {
  double inertia_over_mass = 0.0;  ///< about the vertical through the volume's centre [m^2]
  double height = 0.0;             ///< of that centre above the lowest face [m]
};

/// Volume, first and second moments that a part adds.
struct Moments {
  double volume = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  double square = 0.0;  ///< of the distance to the vertical axis
};

/// Moments of a prism along y, by the triangles of a fan.
Moments moments_of(const PlantPrism& prism) {
  Moments sum;
  const double length = prism.end_y - prism.begin_y;
  const double y = 0.5 * (prism.begin_y + prism.end_y);
  const double y_square = y * y + length * length / 12.0;
  const Eigen::Vector2d& a = prism.outline_xz.front();
  for (std::size_t i = 1; i + 1 < prism.outline_xz.size(); ++i) {
    const Eigen::Vector2d& b = prism.outline_xz[i];
    const Eigen::Vector2d& c = prism.outline_xz[i + 1];
    const Eigen::Vector2d ab = b - a;
    const Eigen::Vector2d ac = c - a;
    const double volume = 0.5 * length * (ab.x() * ac.y() - ab.y() * ac.x());
    const Eigen::Vector2d middle = (a + b + c) / 3.0;
    const double x_square = (a.x() * a.x() + b.x() * b.x() + c.x() * c.x() + a.x() * b.x() +
                             b.x() * c.x() + c.x() * a.x()) /
                            6.0;
    sum.volume += volume;
    sum.first += volume * Eigen::Vector3d(middle.x(), y, middle.y());
    sum.square += volume * (x_square + y_square);
  }
  return sum;
}

MassDistribution mass_distribution(const PlantBody& body) {
  double volume = 0.0;
  double bottom = std::numeric_limits<double>::infinity();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double square = 0.0;
  for (const PlantCuboid& part : body.parts) {
    const double v = 8.0 * part.half_extents.prod();
    volume += v;
    sum += v * part.centre;
    square +=
        v * (part.centre.head<2>().squaredNorm() + part.half_extents.head<2>().squaredNorm() / 3.0);
    bottom = std::min(bottom, part.centre.z() - part.half_extents.z());
  }
  for (const PlantPrism& prism : body.prisms) {
    const Moments moments = moments_of(prism);
    volume += moments.volume;
    sum += moments.first;
    square += moments.square;
  }
  const Eigen::Vector3d centre = sum / volume;
  return {square / volume - centre.head<2>().squaredNorm(), centre.z() - bottom};
}

}  // namespace

BodyDynamics::BodyDynamics(const PlantBody& body, double tip_radius)
    : support_(body),
      contact_(body, tip_radius),
      mass_(body.parameters.mass),
      height_(body.T_base_object.translation().z()),
      is_movable_(body.is_movable),
      centre_(body.T_base_object.translation().head<2>()) {
  const MassDistribution distribution = mass_distribution(body);
  inertia_ = mass_ * distribution.inertia_over_mass;
  centre_height_ = distribution.height;
  yaw_ = yaw_of(body.T_base_object);
  centre_ += Eigen::Rotation2Dd(yaw_) * support_.centre_body();
  limit_ = body.parameters.limiting_static_friction / (mass_ * kStandardGravity);
}

TipLoad BodyDynamics::advance(const Tip& tip, double dt) {
  TipLoad load = contact_.advance(tip, motion(), dt);
  touches_ = load.is_touched;
  normal_ = std::max(0.0, mass_ * kStandardGravity - load.force.z());
  if (!is_movable_) return load;
  if (!load.is_touched && is_resting_) return load;
  const Eigen::Vector2d inertial = mass_ * centre_height_ * acceleration_;
  friction_ = support_.advance(twist_, yaw_,
                               {.extra_normal_force = normal_ - mass_ * kStandardGravity,
                                .tipping_moment = load.tipping_moment - inertial},
                               dt);
  acceleration_ = (load.force.head<2>() + friction_.head<2>()) / mass_;
  twist_.head<2>() += dt * acceleration_;
  twist_.z() += dt * (load.moment + friction_.z()) / inertia_;
  centre_ += dt * twist_.head<2>();
  yaw_ += dt * twist_.z();
  is_resting_ = !load.is_touched && speed() < kRestingSpeed;
  if (is_resting_) {
    twist_.setZero();
    acceleration_.setZero();
    friction_.setZero();
  }
  return load;
}

Pose BodyDynamics::pose() const {
  const BodyMotion now = motion();
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_, Eigen::Vector3d::UnitZ())), now.p_base};
}

PlantBodyState BodyDynamics::state() const {
  return {.p_base = motion().p_base.head<2>(),
          .yaw = yaw_,
          .twist = twist_,
          .friction = friction_,
          .load_factor = support_.load_factor()};
}

PhaseInputs BodyDynamics::phase_inputs() const {
  const double radius = support_.radius();
  const double force = std::hypot(friction_.head<2>().norm(), friction_.z() / radius);
  return {
      .speed = speed(),
      .is_touched = touches_,
      .friction_ratio = normal_ > 0.0 ? force / (limit_ * support_.load_factor() * normal_) : 1.0};
}

double BodyDynamics::speed() const {
  return std::hypot(twist_.head<2>().norm(), support_.radius() * twist_.z());
}

BodyMotion BodyDynamics::motion() const {
  BodyMotion motion;
  motion.R_base_body = Eigen::AngleAxisd(yaw_, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector2d origin =
      centre_ - motion.R_base_body.topLeftCorner<2, 2>() * support_.centre_body();
  motion.p_base = {origin.x(), origin.y(), height_};
  motion.centre_base = {centre_.x(), centre_.y(), height_};
  motion.twist = twist_;
  return motion;
}

SpringArm::SpringArm(const PlantTool& tool)
    : rate_(2.0 * std::numbers::pi * tool.bandwidth),
      mass_(tool.stiffness / (rate_ * rate_)),
      tip_{tool.p_base_start, Eigen::Vector3d::Zero()} {}

void SpringArm::fly(const Eigen::Vector3d& load, double dt) {
  tip_.v_base -= dt / mass_ * load;
  tip_.p_base += dt * tip_.v_base;
}

void SpringArm::advance(const Eigen::Vector3d& p_base, const Eigen::Vector3d& v_base,
                        const Eigen::Vector3d& load, double dt) {
  const Eigen::Vector3d acceleration = rate_ * rate_ * (p_base - tip_.p_base) +
                                       2.0 * kArmDampingRatio * rate_ * (v_base - tip_.v_base) -
                                       load / mass_;
  tip_.v_base += dt * acceleration;
  tip_.p_base += dt * tip_.v_base;
}

}  // namespace pcavr::simulation
