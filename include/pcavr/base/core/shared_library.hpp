// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

struct UnloadLibrary {
  void operator()(void* library) const;
};
/// A shared library, as dlsym takes it; unloaded at its end.
using SharedLibrary = std::unique_ptr<void, UnloadLibrary>;

/// Loads a plugin's library. An Error if the file is missing or is no library for this machine.
[[nodiscard]] Expected<SharedLibrary> load_library(const std::filesystem::path& file);

}  // namespace pcavr
