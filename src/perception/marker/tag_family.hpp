// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <apriltag/apriltag.h>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// A family of libapriltag with its own destroy function.
using AprilTagFamily = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

/// Nothing if the name is not one of libapriltag's families.
[[nodiscard]] std::optional<AprilTagFamily> make_apriltag_family(const std::string& name);

/// OpenCV's number of a predefined ArUco dictionary; nothing if the name is not one.
[[nodiscard]] std::optional<int> aruco_dictionary_number(const std::string& name);

/// The error for an unknown family.
[[nodiscard]] Error unknown_family(const std::string& name);

}  // namespace pcavr
