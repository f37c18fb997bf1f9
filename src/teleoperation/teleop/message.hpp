// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// An object's pose in SE(2) on its support; both sites already know height and tilt.
struct PlanarPose {
  double x = 0.0;    ///< of the object's origin in base [m]
  double y = 0.0;    ///< [m]
  double yaw = 0.0;  ///< see heading_of [rad]
};
[[nodiscard]] PlanarPose planar_pose_of(const Pose& T_base_object);
/// `T_base_start` gives the height and the tilt.
[[nodiscard]] Pose pose_at(const PlanarPose& pose, const Pose& T_base_start);
/// [m] A rotation counts at `rotation_radius` [m].
[[nodiscard]] double distance(const PlanarPose& a, const PlanarPose& b, double rotation_radius);

/// A correction from the robot's site to the operator's. Only what is set is sent.
struct CorrectionMessage {
  double t = 0.0;  ///< [s] time that it corrects
  std::size_t object = 0;
  std::uint8_t sequence = 0;  ///< for the acknowledgement
  CorrectionCase which = CorrectionCase::phases_differ;
  std::optional<PlanarPose> pose = {};
  std::optional<Eigen::Vector3d> twist = {};  ///< [vx vy omega], only with the pose
  /// Case 1.2b: displacement by which the virtual tool is first retracted from the object, base
  /// axes [m]. Case 2: the same, and the tool is kept off until a message of case 2 that retracts
  /// it by zero.
  std::optional<Eigen::Vector3d> tool_retraction = {};
  /// Parameters without those unknown at both sites. Only the standard deviation of F_M is sent.
  ObjectParameters parameters = {};
};

/// Its content: "position", "contact parameters", "friction parameters", joined by '+'.
[[nodiscard]] std::string describe(const CorrectionMessage& message);

/// Little endian: flags and case, object, sequence, time in units of 10 us since `epoch`, then
/// single floats; a bit for each parameter that follows. `t` in [epoch, epoch + 11 hours], object
/// below 256.
[[nodiscard]] std::vector<std::uint8_t> encode(const CorrectionMessage& message, double epoch);
/// Empty if the bytes are not exactly one message, or contain a number that is not finite.
[[nodiscard]] std::optional<CorrectionMessage> decode(std::span<const std::uint8_t> bytes,
                                                      double epoch);

/// Size of one more sample if everything were streamed, in the same encoding: a tracked pose, and a
/// force.
[[nodiscard]] std::size_t bytes_of_tracked_pose();
[[nodiscard]] std::size_t bytes_of_wrench_sample();

}  // namespace pcavr
