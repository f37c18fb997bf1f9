// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/devices/device.hpp"
#include "pcavr/teleoperation/devices/rate_options.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct GamepadOptions {
  GamepadOptions();
  double dead_zone;  ///< ratio of full deflection at which worn sticks rest
  double max_force;  ///< [N] force of the heavy motor's maximum amplitude
  int stop_button;   ///< SDL_GameControllerButton of the emergency stop; not the right shoulder
};
[[nodiscard]] OptionSection section_of(GamepadOptions& options);

/// The first available gamepad, through SDL2. The left stick moves the tip away and sideways, the
/// right one up and down; the clutch is closed while the right shoulder button or trigger is held.
/// The heavy motor vibrates in proportion to the force, the light one by the pulse. The right face
/// button (B, circle) is the emergency stop.
///
/// A thread of its own polls it at 250 Hz. When unplugged it is absent until it, or another one, is
/// connected.
class GamepadDevice final : public Device {
 public:
  [[nodiscard]] static Expected<std::unique_ptr<GamepadDevice>> open(
      const GamepadOptions& options = {}, const RateOptions& rate = {});
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
