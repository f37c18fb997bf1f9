// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"

#include "physics/inputs/evidence.hpp"

namespace pcavr {

/// An error where a turn, or other axes, explain the directions and friction at the tip does not;
/// a note where it may.
struct TurnFinding {
  std::optional<Error> error = {};
  std::string note = {};
  double noted_angle = 0.0;  ///< [rad] of the turn that the note is about, and its std
};
[[nodiscard]] TurnFinding state_force_turn(std::span<const ContactEvidence> evidence);

}  // namespace pcavr
