// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

// Formatting of the findings' messages.

/// Five significant digits: "0.06", "25000".
[[nodiscard]] std::string number(double value);
/// "0.06 m".
[[nodiscard]] std::string metres(double length);
/// A length that was measured, to three digits: "0.12 m".
[[nodiscard]] std::string measured(double length);
/// "12.3 degrees", from radians.
[[nodiscard]] std::string degrees(double angle);
/// "factor 2.00 over 38 frames"; without frames "factor 2.00".
[[nodiscard]] std::string factor_over_frames(double factor, std::size_t frames);
/// "markers[2]".
[[nodiscard]] std::string key_of_marker(std::size_t marker);
/// "objects[0]"; "objects: NAME" where the manifest doesn't name it.
[[nodiscard]] std::string key_of_object(const Manifest& manifest, const std::string& name);

}  // namespace pcavr
