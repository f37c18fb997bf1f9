// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/devices/device.hpp"
#include "pcavr/teleoperation/devices/gamepad_device.hpp"
#include "pcavr/teleoperation/devices/plugin_device.hpp"
#include "pcavr/teleoperation/devices/rate_options.hpp"
#include "pcavr/teleoperation/devices/simulated_force_device.hpp"
#include "pcavr/teleoperation/devices/space_mouse_device.hpp"
#include "pcavr/teleoperation/devices/trace_device.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// The descriptions that open_device accepts, for help texts.
inline constexpr std::string_view kDeviceChoices =
    "spacemouse, gamepad, trace:FILE, simulated, plugin:FILE.so or plugin:FILE.so,OPTIONS";

/// Options of all devices that open_device opens.
struct DeviceOptions {
  RateOptions rate;  ///< of gamepad and SpaceMouse
  GamepadOptions gamepad;
  SpaceMouseOptions space_mouse;
  TraceDeviceOptions trace;
  PluginDeviceOptions plugin;  ///< its text is that of the description
  SimulatedForceDeviceOptions simulated;
};

/// Opens a device by its type and, after a colon, its arguments. An Error for an unknown type,
/// missing hardware or an invalid file.
[[nodiscard]] Expected<std::unique_ptr<Device>> open_device(std::string_view description,
                                                            const DeviceOptions& options = {});

}  // namespace pcavr
