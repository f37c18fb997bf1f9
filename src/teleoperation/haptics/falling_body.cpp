// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/falling_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr::detail {

FallingBody::FallingBody(const Start& start) noexcept
    : centre_of_mass_object_(start.centre_of_mass_object),
      edge_(start.edge.p_base),
      along_(start.edge.along),
      gyration_radius_(start.gyration_radius),
      max_tilt_(start.max_tilt),
      max_fall_height_(start.max_fall_height),
      bounds_object_(start.bounds_object),
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

/// Height in base of the lowest corner of its bounding box [m].
double FallingBody::lowest() const {
  const Pose T = T_base_object();
  double low = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 8; ++i) {
    const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(i);
    low = std::min(low, (T * bounds_object_.corner(corner)).z());
  }
  return low;
}

/// Puts the body to rest on the face whose normal is nearest to the vertical.
void FallingBody::land(double floor) noexcept {
  const Eigen::Vector3d up = q_base_object_.conjugate() * Eigen::Vector3d::UnitZ();
  Eigen::Index axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  const Eigen::Vector3d face = (up[axis] < 0.0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis);
  q_base_object_ = (q_base_object_ * Eigen::Quaterniond::FromTwoVectors(face, up)).normalized();
  centre_.z() += floor - lowest();
  v_.setZero();
  tilt_rate_ = 0.0;
  is_resting_ = true;
}

void FallingBody::step(double gravity, double dt, const FloorHeights& floor) noexcept {
  if (is_resting_) return;
  if (start_height_ - centre_.z() > max_fall_height_) return;
  if (!is_free_) {
    tip_over(gravity, dt);
    return;
  }
  v_.z() -= dt * gravity;
  centre_ += dt * v_;
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(dt * tilt_rate_, along_));
  q_base_object_ = (rotation * q_base_object_).normalized();
  const auto height = floor.below(centre_.head<2>(), edge_.z());
  if (height && lowest() <= *height) land(*height);
}

Pose FallingBody::T_base_object() const {
  return {q_base_object_, centre_ - q_base_object_ * centre_of_mass_object_};
}

}  // namespace pcavr::detail
