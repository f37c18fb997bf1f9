// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcavr/haptics/haptic_world.hpp"

namespace pcavr {

/// What a controller without force feedback gives instead: a hum that follows the force, and a
/// stroke at each first touch and each breakaway. One thread; `step` never allocates.
class PulseMeter {
 public:
  /// `full_force` [N] > 0: at which the hum is at its strongest.
  PulseMeter(std::size_t bodies, double full_force);

  void step(const HapticWorldState& state, double dt) noexcept;
  void reset() noexcept;

  [[nodiscard]] double amplitude() const noexcept { return amplitude_; }  ///< 0 to 1
  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }   ///< strokes so far

 private:
  void strike() noexcept;

  double full_force_;
  double since_stroke_;         ///< [s]
  double since_touch_;          ///< [s]
  std::vector<bool> was_held_;  ///< by body: at rest, and touched
  double amplitude_ = 0.0;
  std::uint32_t count_ = 0;
};

}  // namespace pcavr
