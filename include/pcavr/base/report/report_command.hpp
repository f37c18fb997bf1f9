// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

namespace pcavr {

/// A command line as a shell takes it, without what does not change a report: --force, --json, and
/// -o, --output, --report and --threads with their values. So a report made again has the same
/// bytes; when it was made is its file's date, which its page shows.
[[nodiscard]] std::string command_of(std::span<char* const> words);

/// The command that all reports state that are written from now on; without it they state none.
/// Call it before the program has threads.
void set_report_command(std::string command);
[[nodiscard]] const std::string& report_command();

}  // namespace pcavr
