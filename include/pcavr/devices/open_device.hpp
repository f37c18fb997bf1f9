// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "pcavr/core/expected.hpp"
#include "pcavr/devices/device.hpp"

namespace pcavr {

/// What open_device takes, for help texts.
inline constexpr std::string_view kDeviceChoices =
    "spacemouse, gamepad, trace:FILE, simulated, plugin:FILE.so or plugin:FILE.so,OPTIONS";

/// A device by a word and, after a colon, what it needs; with the defaults of its options. An
/// unknown word, hardware that is not there and a bad file are Errors.
[[nodiscard]] Expected<std::unique_ptr<Device>> open_device(std::string_view description);

}  // namespace pcavr
