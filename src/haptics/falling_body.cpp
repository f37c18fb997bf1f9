// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "haptics/falling_body.hpp"

#include <cmath>

namespace pcavr::detail {
namespace {

/// [rad] A body that leans over an edge farther than this has slipped off it.
constexpr double kSlipsOff = 0.6;
/// [m] After this way down a body stays where it is: out of any picture.
constexpr double kOutOfSight = 5.0;

}  // namespace

FallingBody::FallingBody(const Start& start) noexcept
    : centre_of_mass_object_(start.centre_of_mass_object),
      edge_(start.edge.p_base),
      along_(start.edge.along),
      gyration_radius_(start.gyration_radius),
      centre_(start.T_base_object * start.centre_of_mass_object),
      v_(start.v_base.x(), start.v_base.y(), 0.0),
      q_base_object_(start.T_base_object.rotation()) {
  start_height_ = centre_.z();
  // Where the edge catches the body its turning moment about the edge stays.
  const Eigen::Vector3d arm = centre_ - edge_;
  const Eigen::Vector3d across = arm - arm.dot(along_) * along_;
  const double inertia = gyration_radius_ * gyration_radius_ + across.squaredNorm();
  tilting_ = std::max(across.cross(v_).dot(along_) / inertia, 0.0);
}

void FallingBody::tip_over(double gravity, double dt) noexcept {
  const Eigen::Vector3d arm = centre_ - edge_;
  const Eigen::Vector3d across = arm - arm.dot(along_) * along_;
  const double inertia = gyration_radius_ * gyration_radius_ + across.squaredNorm();
  const double moment = across.cross(Eigen::Vector3d(0.0, 0.0, -gravity)).dot(along_);
  tilting_ += dt * moment / inertia;
  tilt_ += dt * tilting_;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(dt * tilting_, along_));
  const Eigen::Vector3d drift = dt * v_.dot(along_) * along_;
  const Eigen::Vector3d next = edge_ + drift + turn * arm;
  edge_ += drift;
  v_ = (next - centre_) / dt;
  centre_ = next;
  q_base_object_ = (turn * q_base_object_).normalized();
  is_free_ = std::abs(tilt_) > kSlipsOff;
}

void FallingBody::step(double gravity, double dt) noexcept {
  if (start_height_ - centre_.z() > kOutOfSight) return;
  if (!is_free_) {
    tip_over(gravity, dt);
    return;
  }
  v_.z() -= dt * gravity;
  centre_ += dt * v_;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(dt * tilting_, along_));
  q_base_object_ = (turn * q_base_object_).normalized();
}

Pose FallingBody::T_base_object() const {
  return {q_base_object_, centre_ - q_base_object_ * centre_of_mass_object_};
}

}  // namespace pcavr::detail
