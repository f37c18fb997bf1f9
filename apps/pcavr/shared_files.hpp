// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

namespace pcavr::app {

/// The folder of data that was installed with the command, or else `in_source`, its folder in the
/// sources: the one that has `file`. Empty where none has it.
[[nodiscard]] std::filesystem::path find_shared_folder(const std::string& installed,
                                                       const std::string& in_source,
                                                       const std::string& file);

/// For options that name a calibration file: a path calib/... that does not exist in the working
/// folder is that of the calibration files which were installed with the command.
[[nodiscard]] CLI::Validator installed_calibration();

}  // namespace pcavr::app
