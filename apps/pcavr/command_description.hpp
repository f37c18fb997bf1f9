// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace pcavr::app {

/// A command with its arguments, options and subcommands, as manual pages and completion need them:
/// name, description, footer, arguments, options, commands. An option has `names`, `text` (what
/// stands behind the names), `description`, `takes_value`, and `choices` where its values are
/// words of a list. Hidden options are left out.
[[nodiscard]] nlohmann::ordered_json describe_command(const CLI::App& app);

}  // namespace pcavr::app
