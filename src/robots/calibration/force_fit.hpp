// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// A reading as the sensor has it, and gravity in the flange.
struct GravitySample {
  Eigen::Vector3d force, gravity_flange;
  std::optional<Eigen::Vector3d> torque = {};
  bool is_used = true;
};
using GravitySamples = std::vector<GravitySample>;

/// The samples that are used.
[[nodiscard]] std::size_t used_count(const GravitySamples& samples);

/// Least squares of reading = bias + matrix gravity.
struct LinearFit {
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();  ///< of gravity in the flange, summed
  double squares = 0.0;                               ///< [N^2]
};

[[nodiscard]] LinearFit linear_fit(const GravitySamples& samples);

/// reading = bias + sign mass R gravity, with a rotation R.
struct RigidFit {
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  double sign = 1.0, mass = 0.0;
  Eigen::Matrix3d R_sensor_flange = Eigen::Matrix3d::Identity();
  double squares = 0.0;                 ///< [N^2] of the used samples
  Matrix7d inverse = Matrix7d::Zero();  ///< of the normal equations: bias, mass, rotation
  std::size_t used = 0;

  [[nodiscard]] Eigen::Vector3d weight(const GravitySample& sample) const {
    return sign * mass * (R_sensor_flange * sample.gravity_flange);
  }
  /// Its derivatives by mass and rotation.
  [[nodiscard]] Eigen::Matrix<double, 3, 4> weight_slope(const GravitySample& sample) const {
    Eigen::Matrix<double, 3, 4> slope;
    slope.col(0) = sign * (R_sensor_flange * sample.gravity_flange);
    slope.rightCols<3>() = -sign * mass * R_sensor_flange * skew(sample.gravity_flange);
    return slope;
  }
  [[nodiscard]] Eigen::Vector3d residual(const GravitySample& sample) const {
    return sample.force - bias - weight(sample);
  }
  [[nodiscard]] double freedoms() const {
    return std::max(1.0, 3.0 * static_cast<double>(used) - 7.0);
  }
};

/// The rigid fit that is nearest to the linear one.
[[nodiscard]] RigidFit start_of(const LinearFit& linear);
/// Gauss-Newton from the start; the readings are linear in all but the rotation.
[[nodiscard]] RigidFit rigid_fit(const GravitySamples& samples, RigidFit fit);

}  // namespace pcavr
