// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/pose_numbers.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <fmt/format.h>

namespace pcavr {
namespace {

/// Deviation from unit length, and of products of a matrix' columns: programs write three digits or
/// more.
constexpr double kMaxNormError = 5e-3;
/// [rad] A rotation vector is no longer than a turn, but for rounding.
constexpr double kMaxRotation = 2.0 * std::numbers::pi + 0.01;

Expected<Pose> from_quaternion(std::span<const double> numbers, bool is_w_first) {
  const std::size_t w = is_w_first ? 3 : 6, x = is_w_first ? 4 : 3;
  const Eigen::Quaterniond q(numbers[w], numbers[x], numbers[x + 1], numbers[x + 2]);
  if (std::abs(q.norm() - 1.0) > kMaxNormError) {
    return Error{.message = fmt::format("the quaternion has length {:.4g}, not 1", q.norm()),
                 .hint =
                     "write position, then qx, qy, qz, qw; name the columns in a header where "
                     "their order differs"};
  }
  return Pose(q, {numbers[0], numbers[1], numbers[2]});
}

Expected<Pose> from_rotation_vector(std::span<const double> numbers) {
  const Eigen::Vector3d vector = Eigen::Vector3d::Map(numbers.data() + 3);
  const double angle = vector.norm();
  if (angle > kMaxRotation) {
    return Error{.message = fmt::format("the rotation vector is {:.4g} long, more than a turn in "
                                        "radians",
                                        angle),
                 .hint =
                     "where it is in degrees, name the columns in a header: x, y, z, rx_deg, "
                     "ry_deg, rz_deg"};
  }
  const Eigen::Quaterniond q = angle > 0.0
                                   ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle))
                                   : Eigen::Quaterniond::Identity();
  return Pose(q, {numbers[0], numbers[1], numbers[2]});
}

Expected<Pose> pose_of_matrix(std::span<const double> numbers) {
  const Eigen::Matrix<double, 3, 4> rows =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data());
  const Eigen::Matrix3d R = rows.leftCols<3>();
  const double shear = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(shear < kMaxNormError)) {
    return Error{.message = "the matrix has no rotation",
                 .hint = "write it row after row, with the position in the last column"};
  }
  if (R.determinant() < 0.0) {
    return Error{.message = "the matrix mirrors (its determinant is -1)",
                 .hint = "write poses of right-handed frames"};
  }
  return Pose(Eigen::Quaterniond(R), rows.col(3));
}

}  // namespace

const char* name_of(PoseForm form) {
  switch (form) {
    case PoseForm::rotation_vector:
      return "rotation vectors";
    case PoseForm::matrix:
      return "matrices";
    case PoseForm::quaternion:
      break;
  }
  return "quaternions";
}

std::optional<PoseForm> form_of_count(std::size_t count) {
  switch (count) {
    case 6:
      return PoseForm::rotation_vector;
    case 7:
      return PoseForm::quaternion;
    case 12:
    case 16:
      return PoseForm::matrix;
    default:
      return std::nullopt;
  }
}

Expected<Pose> pose_of_numbers(PoseForm form, std::span<const double> numbers, bool is_w_first) {
  switch (form) {
    case PoseForm::rotation_vector:
      return from_rotation_vector(numbers);
    case PoseForm::matrix:
      return pose_of_matrix(numbers);
    case PoseForm::quaternion:
      break;
  }
  return from_quaternion(numbers, is_w_first);
}

}  // namespace pcavr
