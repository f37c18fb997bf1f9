// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/core/expected.hpp"

namespace pcavr {

[[nodiscard]] inline Error can_not_write(const std::filesystem::path& path,
                                         const std::string& reason) {
  return {.message = "can't be written: " + reason,
          .file = path.string(),
          .hint = "choose a folder that you may write to, on a disk with space left"};
}

}  // namespace pcavr
