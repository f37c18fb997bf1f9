// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "pcavr/core/expected.hpp"
#include "pcavr/devices/device.hpp"

namespace pcavr {

/// The descriptions that open_device accepts, for help texts.
inline constexpr std::string_view kDeviceChoices =
    "spacemouse, gamepad, trace:FILE, simulated, plugin:FILE.so or plugin:FILE.so,OPTIONS";

/// Opens a device by its type and, after a colon, its arguments; with default options. An Error for
/// an unknown type, missing hardware or an invalid file.
[[nodiscard]] Expected<std::unique_ptr<Device>> open_device(std::string_view description);

}  // namespace pcavr
