// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "console.hpp"

namespace pcavr::app {

/// Each adds one command of `calibrate`.
void add_calibrate_camera(CLI::App& calibrate, Action& action);

}  // namespace pcavr::app
