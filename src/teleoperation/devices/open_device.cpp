// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/open_device.hpp"

#include <string>
#include <utility>

namespace pcavr {
namespace {

using Opened = Expected<std::unique_ptr<Device>>;

template <typename Kind>
Opened as_device(Expected<std::unique_ptr<Kind>> opened) {
  if (!opened) return opened.error();
  return std::unique_ptr<Device>(*std::move(opened));
}

}  // namespace

Opened open_device(std::string_view description, const DeviceOptions& options) {
  const std::size_t colon = description.find(':');
  const std::string_view type = description.substr(0, colon);
  const std::string_view rest =
      colon == description.npos ? std::string_view() : description.substr(colon + 1);
  const bool has_arguments = colon != description.npos;
  if (type == "spacemouse" && !has_arguments) {
    return as_device(SpaceMouseDevice::open(options.space_mouse, options.rate));
  }
  if (type == "gamepad" && !has_arguments) {
    return as_device(GamepadDevice::open(options.gamepad, options.rate));
  }
  if (type == "simulated" && !has_arguments) {
    return std::unique_ptr<Device>(std::make_unique<SimulatedForceDevice>(options.simulated));
  }
  if (type == "trace" && !rest.empty()) return as_device(TraceDevice::open(rest, options.trace));
  if (type == "plugin" && !rest.empty()) {
    const std::size_t comma = rest.find(',');
    PluginDeviceOptions plugin = options.plugin;
    if (comma != rest.npos) plugin.text = rest.substr(comma + 1);
    return as_device(PluginDevice::open(rest.substr(0, comma), plugin));
  }
  return Error{.message = "unknown device '" + std::string(description) + "'",
               .hint = "choose " + std::string(kDeviceChoices)};
}

}  // namespace pcavr
