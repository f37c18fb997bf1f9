// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "pcavr/base/core/expected.hpp"

namespace pcavr::app {

/// What is wrong with a command line that CLI11 rejected, with the name of the command or option
/// that was probably meant, and how to get help. `app` has parsed the line.
[[nodiscard]] Error usage_error(const CLI::App& app, const CLI::ParseError& error);

/// The first word in place of a command, which CLI11 reports as a missing one, and not at all
/// where help is asked for; else empty.
[[nodiscard]] std::string unknown_command(const CLI::App& app);

/// The command that was invoked, with its subcommand: the program itself where there is none.
[[nodiscard]] const CLI::App& invoked_command(const CLI::App& app);

/// Its name with those of the commands that it belongs to: "pcavr identify friction".
[[nodiscard]] std::string full_name(const CLI::App& command);

}  // namespace pcavr::app
