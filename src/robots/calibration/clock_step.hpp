// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/robots/calibration/clock_offset.hpp"

#include "velocity_signal.hpp"

namespace pcavr {

/// The clock with the step that the samples show, if they do: where another offset from some
/// instant on explains the motion better than one offset and one drift do, by more than their noise
/// makes of any instant. `start` is the clock without a step.
[[nodiscard]] std::optional<ClockOffset> find_clock_step(const VelocitySignal& a,
                                                         const VelocitySamples& samples,
                                                         const ClockOffset& start, bool with_drift);

}  // namespace pcavr
