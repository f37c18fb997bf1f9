// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <apriltag/apriltag.h>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// A family of libapriltag; destroyed by the function that belongs to it.
using AprilTagFamily = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

/// Nothing where the name is not one of libapriltag's families.
[[nodiscard]] std::optional<AprilTagFamily> make_apriltag_family(const std::string& name);

/// OpenCV's number of a predefined ArUco dictionary; nothing where the name is not one.
[[nodiscard]] std::optional<int> aruco_dictionary_number(const std::string& name);

/// What to say about a family that nobody knows.
[[nodiscard]] Error unknown_family(const std::string& name);

}  // namespace pcavr
