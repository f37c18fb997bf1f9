// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace pcavr {

/// One folder's name, since results lie in it; one that begins with '.' or '_' is none.
[[nodiscard]] bool is_support_name(const std::string& name);

/// What a recording's objects stand on: the name of the folder that it lies in, "unnamed" where
/// that is no name of a support. `recording`: absolute.
[[nodiscard]] std::string support_of(const std::filesystem::path& recording);

}  // namespace pcavr
