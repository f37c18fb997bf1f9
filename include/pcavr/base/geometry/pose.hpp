// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pcavr {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A rigid transformation. Named T_a_b it is the pose of frame b in frame a, and maps coordinates
/// in b to coordinates in a. Perturbations are right-multiplied twists: T * exp([v; w]), with v
/// [m] and w [rad] in b's axes; pose covariances refer to that 6-vector.
class Pose {
 public:
  /// The identity.
  Pose() = default;

  /// q_a_b is normalised. Throws ContractError unless all is finite and |q_a_b| > 1e-6.
  Pose(const Eigen::Quaterniond& q_a_b, const Eigen::Vector3d& p_a_b);

  /// The pose of a 4x4 matrix, whose rotation is projected onto SO(3). Throws ContractError where
  /// the matrix is further than 0.05 from a rigid one in any entry, or not finite.
  [[nodiscard]] static Pose from_matrix(const Eigen::Matrix4d& matrix);

  [[nodiscard]] static Pose from_translation(const Eigen::Vector3d& p_a_b);

  /// The exponential of a twist [v; w] [Murray, Li & Sastry 1994, eq. 2.36].
  [[nodiscard]] static Pose exp(const Vector6d& twist);
  /// The twist [v; w] whose exponential this is, with |w| <= pi.
  [[nodiscard]] Vector6d log() const;

  [[nodiscard]] const Eigen::Quaterniond& rotation() const { return rotation_; }
  [[nodiscard]] const Eigen::Vector3d& translation() const { return translation_; }
  [[nodiscard]] Eigen::Matrix3d rotation_matrix() const { return rotation_.toRotationMatrix(); }
  [[nodiscard]] Eigen::Matrix4d matrix() const;

  [[nodiscard]] Pose inverse() const;
  [[nodiscard]] Pose operator*(const Pose& T_b_c) const;
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p_b) const {
    return rotation_ * p_b + translation_;
  }

 private:
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

/// Interpolates from a (fraction 0) to b (1): linear in translation, slerp in rotation.
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// Angle of the rotation from a to b [rad], in [0, pi].
[[nodiscard]] double rotation_distance(const Pose& a, const Pose& b);

/// Distance between the origins of a and b [m].
[[nodiscard]] double translation_distance(const Pose& a, const Pose& b);

/// The skew-symmetric matrix S with S * b == a x b.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& a);

}  // namespace pcavr
