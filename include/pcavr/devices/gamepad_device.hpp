// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/core/expected.hpp"
#include "pcavr/devices/device.hpp"
#include "pcavr/devices/rate_options.hpp"

namespace pcavr {

struct GamepadOptions {
  RateOptions rate;
  double max_force = 5.0;  ///< [N] > 0 at which the heavy motor runs at its strongest
};

/// A gamepad, through SDL2: the first there is. The left stick moves the tip away and sideways, the
/// right one up and down; the clutch is the right shoulder or the right trigger, held. Its heavy
/// motor follows the force, its light one the pulse.
///
/// A thread of its own asks it 250 times a second. Unplugged, it is not present until it, or
/// another, is there.
class GamepadDevice final : public Device {
 public:
  [[nodiscard]] static Expected<std::unique_ptr<GamepadDevice>> open(
      const GamepadOptions& options = {});
  ~GamepadDevice() override;

  [[nodiscard]] std::string_view name() const noexcept override;
  [[nodiscard]] DeviceSample exchange(double t, double dt,
                                      const DeviceFeedback& feedback) noexcept override;

 private:
  struct Content;
  explicit GamepadDevice(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
