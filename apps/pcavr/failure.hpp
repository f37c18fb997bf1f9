// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/expected.hpp"

namespace pcavr::app {

/// Translates an exception into an error for the user: out of memory or threads, a system error, or
/// else an internal error (a bug).
[[nodiscard]] Error error_of(const std::exception& failure);

/// {"error": {...}} with the non-empty parts of the error, its one-line form as `text`, and the
/// exit code.
[[nodiscard]] nlohmann::ordered_json error_json(const Error& error, int exit_code);

}  // namespace pcavr::app
