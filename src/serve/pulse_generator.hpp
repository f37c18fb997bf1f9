// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcavr/serve/live_world.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

namespace pcavr {

/// Vibrotactile feedback for controllers without force feedback: a continuous vibration in
/// proportion to the force, and a pulse at each first contact and each breakaway. One thread;
/// `step` never allocates.
class PulseGenerator {
 public:
  /// `full_scale_force` [N] > 0: force of the strongest continuous vibration.
  PulseGenerator(std::size_t bodies, double full_scale_force, const VibrationOptions& options = {});

  void step(const HapticWorldState& state, double dt) noexcept;
  void reset() noexcept;

  [[nodiscard]] double amplitude() const noexcept { return amplitude_; }  ///< 0 to 1
  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }   ///< pulses so far

 private:
  void start_pulse() noexcept;

  double full_scale_force_;
  VibrationOptions options_;
  double since_pulse_;            ///< [s]
  double since_contact_;          ///< [s]
  std::vector<bool> was_static_;  ///< by body: touched and at rest (static or critical)
  double amplitude_ = 0.0;
  std::uint32_t count_ = 0;
};

}  // namespace pcavr
