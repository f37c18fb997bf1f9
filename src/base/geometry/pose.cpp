// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/pose.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

/// Below this angle [rad] Taylor series replace closed forms, which lose digits by cancellation.
constexpr double kSmallAngle = 1e-4;

/// The left Jacobian V of SO(3) with p = V v, for a rotation vector w [Murray, Li & Sastry 1994,
/// eq. 2.36].
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = skew(w);
  const double square = angle * angle;
  const double a = angle < kSmallAngle ? 0.5 - square / 24.0 : (1.0 - std::cos(angle)) / square;
  const double b = angle < kSmallAngle ? 1.0 / 6.0 - square / 120.0
                                       : (angle - std::sin(angle)) / (square * angle);
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d S;
  S << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return S;
}

Pose::Pose(const Eigen::Quaterniond& q_a_b, const Eigen::Vector3d& p_a_b)
    : rotation_(q_a_b), translation_(p_a_b) {
  const double norm = q_a_b.norm();
  PCAVR_REQUIRE(std::isfinite(norm) && norm > 1e-6, norm);
  PCAVR_REQUIRE(p_a_b.allFinite(), p_a_b.x(), p_a_b.y(), p_a_b.z());
  rotation_.normalize();
}

Pose Pose::from_matrix(const Eigen::Matrix4d& matrix) {
  PCAVR_REQUIRE(matrix.allFinite());
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  const double max_error =
      std::max((rotation - linear).cwiseAbs().maxCoeff(),
               (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff());
  PCAVR_REQUIRE(rotation.determinant() > 0.0 && max_error < 0.05, max_error);
  return Pose(Eigen::Quaterniond(rotation), matrix.topRightCorner<3, 1>());
}

Pose Pose::from_translation(const Eigen::Vector3d& p_a_b) {
  return Pose(Eigen::Quaterniond::Identity(), p_a_b);
}

Pose Pose::exp(const Vector6d& twist) {
  const Eigen::Vector3d w = twist.tail<3>();
  const double angle = w.norm();
  const double half = 0.5 * angle;
  const double factor = angle < kSmallAngle ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  const Eigen::Vector3d xyz = factor * w;
  return Pose(Eigen::Quaterniond(std::cos(half), xyz.x(), xyz.y(), xyz.z()),
              left_jacobian(w) * twist.head<3>());
}

Vector6d Pose::log() const {
  const double sign = rotation_.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d xyz = sign * rotation_.vec();
  const double sine = xyz.norm();
  const double angle = 2.0 * std::atan2(sine, sign * rotation_.w());
  const Eigen::Vector3d w = xyz * (sine < kSmallAngle ? 2.0 + sine * sine / 3.0 : angle / sine);
  Vector6d twist;
  twist << left_jacobian(w).inverse() * translation_, w;
  return twist;
}

Eigen::Matrix4d Pose::matrix() const {
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  result.topLeftCorner<3, 3>() = rotation_matrix();
  result.topRightCorner<3, 1>() = translation_;
  return result;
}

Pose Pose::inverse() const {
  Pose result;
  result.rotation_ = rotation_.conjugate();
  result.translation_ = -(result.rotation_ * translation_);
  return result;
}

Pose Pose::operator*(const Pose& T_b_c) const {
  Pose result;
  result.rotation_ = (rotation_ * T_b_c.rotation_).normalized();
  result.translation_ = rotation_ * T_b_c.translation_ + translation_;
  return result;
}

Pose interpolate(const Pose& a, const Pose& b, double fraction) {
  return Pose(a.rotation().slerp(fraction, b.rotation()),
              (1.0 - fraction) * a.translation() + fraction * b.translation());
}

double rotation_distance(const Pose& a, const Pose& b) {
  return (a.inverse() * b).log().tail<3>().norm();
}

double translation_distance(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}

}  // namespace pcavr
