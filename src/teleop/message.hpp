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

#include "pcavr/geometry/pose.hpp"
#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/teleop/run_teleop.hpp"

namespace pcavr {

/// Where an object stands on its support; height and tilt are both sites' knowledge already.
struct PlanarPlace {
  double x = 0.0;    ///< of the object's origin in base [m]
  double y = 0.0;    ///< [m]
  double yaw = 0.0;  ///< see heading_of [rad]
};
[[nodiscard]] PlanarPlace place_of(const Pose& T_base_object);
/// `T_base_start` gives the height and the tilt.
[[nodiscard]] Pose pose_at(const PlanarPlace& place, const Pose& T_base_start);

/// What the robot's site tells the operator's. Only what is set travels.
struct CorrectionMessage {
  double t = 0.0;  ///< [s] the instant it speaks of
  std::size_t object = 0;
  std::uint8_t sequence = 0;  ///< by which its arrival is confirmed
  CorrectionCase which = CorrectionCase::phases_differ;
  std::optional<PlanarPlace> place = {};
  std::optional<Eigen::Vector3d> twist = {};  ///< [vx vy omega], with the place
  /// Case 1.2b: by how much the virtual tool is first led out of the object, base axes [m].
  std::optional<Eigen::Vector3d> lead_out = {};
  /// Those of which both sites know nothing stay out. Of the deviations, that of F_M travels.
  ObjectParameters parameters = {};
};

/// What it holds: "position", "contact parameters", "friction parameters", joined by '+'.
[[nodiscard]] std::string describe(const CorrectionMessage& message);

/// Little endian: flags and case, object, sequence, time in units of 10 us since `epoch`, then
/// single floats; a bit for each parameter that follows. `t` in [epoch, epoch + 11 hours], object
/// below 256.
[[nodiscard]] std::vector<std::uint8_t> encode(const CorrectionMessage& message, double epoch);
/// Nothing where the bytes are not such a message to the last one, or hold a number that is not
/// finite.
[[nodiscard]] std::optional<CorrectionMessage> decode(std::span<const std::uint8_t> bytes,
                                                      double epoch);

/// What one more sample would cost if everything were sent, in the same encoding: a tracked place,
/// and a force.
[[nodiscard]] std::size_t bytes_of_tracked_pose();
[[nodiscard]] std::size_t bytes_of_wrench_sample();

}  // namespace pcavr
