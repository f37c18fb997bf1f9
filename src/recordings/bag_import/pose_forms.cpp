// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/pose_forms.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pcavr {
namespace {

// Columns of a rotation whose products differ more from those of unit vectors are none: loggers
// write six digits.
constexpr double kMaxShear = 1e-3;

void append(const Eigen::Vector3d& p, const Eigen::Quaterniond& q, std::vector<double>& values) {
  values = {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

Eigen::Quaterniond rotation_of(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (!(angle > 0.0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation_vector / angle));
}

Eigen::Quaterniond rotation_zyx(double a, double b, double c) {
  return Eigen::AngleAxisd(a, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(b, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(c, Eigen::Vector3d::UnitX());
}

MessageNumbers from_matrix(const std::vector<double>& numbers) {
  const Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix4d>(numbers.data());
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const bool is_rotation =
      (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kMaxShear &&
      R.determinant() > 0.0;
  MessageNumbers message;
  if (!is_rotation) {
    message.fault = "its matrix has no rotation; it is read column after column";
    return message;
  }
  append(T.topRightCorner<3, 1>(), Eigen::Quaterniond(R).normalized(), message.values);
  return message;
}

/// The same with z up in the place of y, for the world and for bodies alike: (x, y, z) is
/// (x, -z, y).
void turn_up(std::vector<double>& values) {
  if (values.size() != 3 && values.size() != 7) return;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    const double y = values[i + 1];
    values[i + 1] = -values[i + 2];
    values[i + 2] = y;
  }
}

}  // namespace

MessageNumbers message_numbers(const CsvLayout::Series& series, bool is_y_up,
                               std::vector<double> numbers) {
  MessageNumbers message;
  switch (series.form) {
    case RowForm::message:
      message.values = std::move(numbers);
      break;
    case RowForm::force:
      message.values = std::move(numbers);
      message.values.resize(6, 0.0);
      break;
    case RowForm::rotation_vector:
      append(Eigen::Vector3d::Map(numbers.data()),
             rotation_of(Eigen::Vector3d::Map(numbers.data() + 3)), message.values);
      break;
    case RowForm::matrix:
      message = from_matrix(numbers);
      break;
    case RowForm::angles_zyx:
      append(Eigen::Vector3d::Map(numbers.data()), rotation_zyx(numbers[3], numbers[4], numbers[5]),
             message.values);
      break;
  }
  if (is_y_up) turn_up(message.values);
  return message;
}

}  // namespace pcavr
