// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "support/source_folder.hpp"

/// The shared recordings: the folder in PCAVR_DATA, by default ../shared/data next to the source
/// tree. They are not part of the project.
inline std::filesystem::path shared_data(const std::filesystem::path& relative) {
  const char* configured = std::getenv("PCAVR_DATA");
  const std::filesystem::path root = configured != nullptr ? std::filesystem::path(configured)
                                                           : source_folder() / "../shared/data";
  return root / relative;
}

/// Skips the test by name where a shared recording is absent.
#define PCAVR_NEEDS_SHARED_DATA(relative)                                                  \
  if (!std::filesystem::exists(shared_data(relative))) {                                   \
    GTEST_SKIP() << "needs " << shared_data(relative) << "; set PCAVR_DATA to its folder"; \
  }                                                                                        \
  static_assert(true)
