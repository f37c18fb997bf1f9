// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "console.hpp"

namespace pcavr::app {

/// Each adds one command of `calibrate`.
void add_calibrate_camera(CLI::App& calibrate, Action& action);
void add_calibrate_depth(CLI::App& calibrate, Action& action);
void add_calibrate_force(CLI::App& calibrate, Action& action);
void add_calibrate_objects(CLI::App& calibrate, Action& action);
void add_calibrate_tags(CLI::App& calibrate, Action& action);
void add_calibrate_touch(CLI::App& calibrate, Action& action);

}  // namespace pcavr::app
