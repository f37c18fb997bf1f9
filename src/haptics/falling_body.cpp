// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "haptics/falling_body.hpp"

#include <cmath>

namespace pcavr::detail {

FallingBody::FallingBody(const Start& start) noexcept
    : centre_of_mass_object_(start.centre_of_mass_object),
      edge_(start.edge.p_base),
      along_(start.edge.along),
      gyration_radius_(start.gyration_radius),
      max_tilt_(start.max_tilt),
      max_fall_height_(start.max_fall_height),
      centre_(start.T_base_object * start.centre_of_mass_object),
      v_(start.v_base.x(), start.v_base.y(), 0.0),
      q_base_object_(start.T_base_object.rotation()) {
  start_height_ = centre_.z();
  // The angular momentum about the edge is conserved.
  const Eigen::Vector3d arm = centre_ - edge_;
  const Eigen::Vector3d lever = arm - arm.dot(along_) * along_;
  const double inertia = gyration_radius_ * gyration_radius_ + lever.squaredNorm();
  tilt_rate_ = std::max(lever.cross(v_).dot(along_) / inertia, 0.0);
}

void FallingBody::tip_over(double gravity, double dt) noexcept {
  const Eigen::Vector3d arm = centre_ - edge_;
  const Eigen::Vector3d lever = arm - arm.dot(along_) * along_;
  const double inertia = gyration_radius_ * gyration_radius_ + lever.squaredNorm();
  const double moment = lever.cross(Eigen::Vector3d(0.0, 0.0, -gravity)).dot(along_);
  tilt_rate_ += dt * moment / inertia;
  tilt_ += dt * tilt_rate_;
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(dt * tilt_rate_, along_));
  const Eigen::Vector3d drift = dt * v_.dot(along_) * along_;
  const Eigen::Vector3d next = edge_ + drift + rotation * arm;
  edge_ += drift;
  v_ = (next - centre_) / dt;
  centre_ = next;
  q_base_object_ = (rotation * q_base_object_).normalized();
  is_free_ = std::abs(tilt_) > max_tilt_;
}

void FallingBody::step(double gravity, double dt) noexcept {
  if (start_height_ - centre_.z() > max_fall_height_) return;
  if (!is_free_) {
    tip_over(gravity, dt);
    return;
  }
  v_.z() -= dt * gravity;
  centre_ += dt * v_;
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(dt * tilt_rate_, along_));
  q_base_object_ = (rotation * q_base_object_).normalized();
}

Pose FallingBody::T_base_object() const {
  return {q_base_object_, centre_ - q_base_object_ * centre_of_mass_object_};
}

}  // namespace pcavr::detail
