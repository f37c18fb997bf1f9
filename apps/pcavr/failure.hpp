// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

#include <nlohmann/json.hpp>

#include "pcavr/core/expected.hpp"

namespace pcavr::app {

/// What an exception means to a user: that memory or threads ran out, that the system refused
/// something, or else that the command has a bug.
[[nodiscard]] Error error_of(const std::exception& failure);

/// {"error": {...}} with the parts of the error that are there, its line as `text`, and the exit
/// code.
[[nodiscard]] nlohmann::ordered_json error_json(const Error& error, int exit_code);

}  // namespace pcavr::app
