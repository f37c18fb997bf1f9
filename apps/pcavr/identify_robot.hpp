// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "configuration.hpp"
#include "console.hpp"

namespace pcavr::app {

/// Adds `robot` to `pcavr identify`.
void add_identify_robot(CLI::App& app, Configuration& configuration, Action& action);

}  // namespace pcavr::app
