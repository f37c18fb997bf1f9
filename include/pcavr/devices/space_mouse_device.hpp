// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/core/expected.hpp"
#include "pcavr/devices/device.hpp"
#include "pcavr/devices/rate_options.hpp"

namespace pcavr {

/// A 3Dconnexion SpaceMouse or the like, through the daemon spacenavd. The cap's push is the tip's
/// velocity; the clutch is the left button, held: a cap that is bumped moves nothing. Turning the
/// cap does nothing, a ball has no sides.
///
/// A thread of its own waits for the daemon. A cap that is unplugged, or a daemon that ends, is not
/// present from then on. libspnav has one connection to a process: a second open fails.
class SpaceMouseDevice final : public Device {
 public:
  /// Waits for the daemon for at most some tenths of a second.
  [[nodiscard]] static Expected<std::unique_ptr<SpaceMouseDevice>> open(
      const RateOptions& options = {});
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
