// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The hint for a file that can't be written.
[[nodiscard]] inline const char* hint_for(const std::error_code& code) {
  if (code == std::errc::too_many_files_open || code == std::errc::too_many_files_open_in_system) {
    return "raise the limit of open files (ulimit -n), or end programs that hold many";
  }
  if (code == std::errc::no_space_on_device) return "free space, or choose another disk";
  if (code == std::errc::filename_too_long) return "choose a shorter name";
  return "choose a folder that you may write to";
}

[[nodiscard]] inline Error can_not_write(const std::filesystem::path& path,
                                         const std::error_code& code) {
  return {.message = "can't be written: " + code.message(),
          .file = path.string(),
          .hint = hint_for(code)};
}

/// The same, by a number of errno.
[[nodiscard]] inline Error can_not_write(const std::filesystem::path& path, int number) {
  return can_not_write(path, std::error_code(number, std::system_category()));
}

}  // namespace pcavr
