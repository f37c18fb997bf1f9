// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "teleoperation/teleop/message.hpp"

namespace pcavr {

/// A correction of case 1.2b that only retracts the tool, by `displacement` [m], from `object`. Its
/// sequence number is far from those of a robot's site that has just begun.
inline std::vector<std::uint8_t> retraction_message(double t, std::size_t object,
                                                    const Eigen::Vector3d& displacement) {
  CorrectionMessage message;
  message.t = t;
  message.object = object;
  message.which = CorrectionCase::touched_by_robot;
  message.tool_retraction = displacement;
  message.sequence = 100;
  return encode(message, t);
}

}  // namespace pcavr
