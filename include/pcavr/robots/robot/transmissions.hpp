// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The motor and gear of one joint, as a description states them.
struct JointTransmission {
  std::string joint;
  double reduction = 1.0;                     ///< motor's speed over the joint's; not 0
  std::optional<double> rotor_inertia = {};   ///< of the rotor itself [kg m^2], > 0
  std::optional<double> gear_stiffness = {};  ///< between encoder and link, at the joint [N m/rad]

  /// Inertia of the rotor, seen from the joint [kg m^2].
  [[nodiscard]] std::optional<double> reflected_inertia() const {
    if (!rotor_inertia) return std::nullopt;
    return reduction * reduction * *rotor_inertia;
  }
};

/// Each `<transmission>` of a description that has one joint and one actuator, in order. Of the
/// actuator are read: `<mechanicalReduction>` (ROS; of the joint or the transmission, too) or
/// `<drake:gear_ratio value>`, `<rotorInertia>` or `<drake:rotor_inertia value>` (Drake), and
/// `<gearStiffness>`. Errors: not XML, or a number that is not positive, with its line.
/// Pure function.
[[nodiscard]] Expected<std::vector<JointTransmission>> parse_transmissions(
    const std::string& text, const std::filesystem::path& file);

}  // namespace pcavr
