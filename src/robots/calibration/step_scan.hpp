// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "velocity_signal.hpp"

namespace pcavr {

/// Two offsets of a clock, the second from an instant of b's stamps on.
struct SteppedOffsets {
  double at = 0.0;                   ///< [s] of b's stamps
  double before = 0.0, after = 0.0;  ///< [s]
};

/// Of all instants and pairs of offsets within a second of `centre` those that leave least of
/// |a - R b|^2. `drift` [1] is taken off before.
[[nodiscard]] SteppedOffsets scan_for_step(const VelocitySignal& a, const VelocitySamples& samples,
                                           double centre, double drift);

}  // namespace pcavr
