// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The arm at rest in one pose, nothing touching the load, and what the force sensor reads.
struct ForceReading {
  std::string name;  ///< as messages name it: "pose 7"
  Eigen::Quaterniond R_base_flange = Eigen::Quaterniond::Identity();
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  std::optional<Eigen::Vector3d> torque = {};       ///< [N m]
};

/// In whose axes the readings are: the sensor's own, or the base's, to which the driver turned
/// them.
enum class ForceAxes { sensor, base };

struct ForceSensorOptions {
  Eigen::Vector3d up_base = Eigen::Vector3d::UnitZ();  ///< against gravity, in the base
};

/// By axis of the flange, which of its axes a sensor axis reads.
struct ReadAxis {
  int axis = 0;  ///< 0 to 2: of the flange, the nearest one
  bool is_reversed = false;
  double angle = 0.0;  ///< [rad] from it
};

struct ForceResidual {
  std::string name;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] reading less model
  bool is_outlier = false;                          ///< not fitted
};

/// The model: reading = force_bias + sign mass R_sensor_flange R_base_flange^T gravity_base, in
/// the sensor's axes.
struct ForceSensorResult {
  ForceAxes axes = ForceAxes::sensor;
  bool is_pose_inverted = false;  ///< the rotations fit only as those of the base in the flange
  double sign = 1.0;  ///< 1: the weight is read as it pulls; -1: reversed, or left-handed
  double mass = 0.0, mass_std = 0.0;  ///< [kg] beyond the sensor
  Eigen::Quaterniond R_sensor_flange = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rotation_std = Eigen::Vector3d::Zero();  ///< [rad] about the flange's axes
  Eigen::Vector3d force_bias = Eigen::Vector3d::Zero();    ///< [N]
  Eigen::Vector3d force_bias_std = Eigen::Vector3d::Zero();
  ReadAxis read_axes[3] = {};
  /// [m] of the load's centre, in the sensor's axes from its origin; without torques: none.
  std::optional<Eigen::Vector3d> centre = {};
  Eigen::Vector3d centre_std = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_bias = Eigen::Vector3d::Zero();  ///< [N m]
  Eigen::Vector3d torque_bias_std = Eigen::Vector3d::Zero();
  double torque_rms = 0.0;  ///< [N m] per axis
  /// Readings over true forces, axis by axis, in the sensor's axes: the identity but for gains and
  /// cross-talk.
  Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d gain_std = Eigen::Matrix3d::Zero();
  bool has_cross_talk = false;  ///< by more than the noise (chance: once in 1000)
  double residual_rms = 0.0;    ///< [N] per axis, of the fitted poses
  double held_out_rms = 0.0;    ///< [N] per axis, each pose by the others
  /// [N] per axis with the readings in the other axes: how clear the choice is.
  double other_axes_rms = 0.0;
  std::vector<ForceResidual> residuals = {};
  std::vector<std::string> notes = {};  ///< for the user
};

/// Identifies the sensor's bias, the load, and how the sensor is turned, from poses at rest. The
/// axes of the readings are found by trying both. An Error where the readings do not change with
/// the pose, where the orientations do not show all three axes, and where no model fits.
/// Thread-safe.
[[nodiscard]] Expected<ForceSensorResult> calibrate_force_sensor(
    const std::vector<ForceReading>& readings, const ForceSensorOptions& options = {});

/// "x reads the flange's +y, y its -x, z its +z, each within 1.2 degrees; in the sensor's axes;
/// ..."
[[nodiscard]] std::string describe_force_axes(const ForceSensorResult& result);

}  // namespace pcavr
