// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/devices/device.hpp"
#include "pcavr/teleoperation/devices/rate_options.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct SpaceMouseOptions {
  SpaceMouseOptions();
  double full_deflection;  ///< [counts] of the cap, at the sensitivity that the daemon is set to
  int stop_button;         ///< the daemon's number of the emergency stop's button; 0 is the clutch
};
[[nodiscard]] OptionSection section_of(SpaceMouseOptions& options);

/// A 3Dconnexion SpaceMouse or the like, through the daemon spacenavd. The cap's deflection is
/// the tip's velocity; the clutch is closed while the left button is held, so that bumping the cap
/// moves nothing. The right button is the emergency stop. Rotations are ignored, since the tool is
/// a sphere.
///
/// A thread of its own reads from the daemon. The device is absent while unplugged, and after the
/// daemon has ended. libspnav has one connection per process: a second open fails.
class SpaceMouseDevice final : public Device {
 public:
  /// Waits for the daemon for at most some tenths of a second.
  [[nodiscard]] static Expected<std::unique_ptr<SpaceMouseDevice>> open(
      const SpaceMouseOptions& options = {}, const RateOptions& rate = {});
  ~SpaceMouseDevice() override;

  [[nodiscard]] std::string_view name() const noexcept override;
  [[nodiscard]] DeviceSample exchange(double t, double dt,
                                      const DeviceFeedback& feedback) noexcept override;

 private:
  struct Content;
  explicit SpaceMouseDevice(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
