// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/devices/device.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct PluginDeviceOptions {
  PluginDeviceOptions();
  std::string text;   ///< passed to the plugin
  double facing;      ///< [rad] about base's z, from its x axis: the operator's viewing direction
  double max_speed;   ///< [m/s] of the tip; see RemoteDeviceOptions
  double slow_limit;  ///< [s] an exchange that takes longer counts as slow
};
[[nodiscard]] OptionSection section_of(PluginDeviceOptions& options);

/// Statistics of a plugin's exchange calls.
struct PluginHealth {
  double slowest = 0.0;      ///< [s] maximum duration of an exchange
  std::uint64_t slow = 0;    ///< exchanges longer than `slow_limit`
  std::uint64_t faults = 0;  ///< rejected results: not 0, not finite or beyond 100 m
};

/// A device from a shared library that exports device_plugin.h. It runs in this process and in the
/// world's thread: its results are checked, but a plugin that hangs or crashes stops the process.
///
/// The clutch keeps the offset between the device's tip and the tool while it is closed; a rejected
/// result opens it. An exception from the plugin counts as a fault, if it was built with the same
/// C++ runtime.
class PluginDevice final : public Device {
 public:
  /// Loads and opens it. An Error if the file is missing, is not a library, lacks the function or
  /// has another ABI, or if the device does not open.
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
