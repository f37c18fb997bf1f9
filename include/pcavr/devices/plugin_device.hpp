// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "pcavr/core/expected.hpp"
#include "pcavr/devices/device.hpp"

namespace pcavr {

struct PluginDeviceOptions {
  std::string text = {};   ///< handed to the plugin
  double facing = 0.0;     ///< [rad] about base's z, from its x axis: where the operator looks
  double max_speed = 2.0;  ///< [m/s] > 0 of the tip; see RemoteDeviceOptions
};

/// How a plugin behaved so far.
struct PluginHealth {
  double slowest = 0.0;      ///< [s] the longest that one exchange took
  std::uint64_t slow = 0;    ///< exchanges that took longer than 100 us
  std::uint64_t faults = 0;  ///< left out: an answer that is not 0, not finite or beyond 100 m
};

/// A device from a shared library that exports device_plugin.h. It runs in this process and in the
/// world's thread: what it answers is checked, but a plugin that hangs or crashes takes all along.
///
/// The clutch keeps the difference between the device's tip and the tool while it is closed; an
/// answer that is left out opens it. An exception that leaves the plugin is a fault, where it was
/// built with the same C++ runtime.
class PluginDevice final : public Device {
 public:
  /// Loads and opens it. A file that is not there, is no library or lacks the function, another ABI
  /// and a device that does not open are Errors.
  [[nodiscard]] static Expected<std::unique_ptr<PluginDevice>> open(
      const std::filesystem::path& library, const PluginDeviceOptions& options = {});
  ~PluginDevice() override;

  /// Any thread.
  [[nodiscard]] PluginHealth health() const noexcept;

  [[nodiscard]] std::string_view name() const noexcept override;
  [[nodiscard]] DeviceSample exchange(double t, double dt,
                                      const DeviceFeedback& feedback) noexcept override;

 private:
  struct Content;
  explicit PluginDevice(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
