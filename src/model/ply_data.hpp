// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace pcavr::model {

/// The contents of a binary PLY whose data begin with a byte that assimp takes for the end of the
/// header's last line: one such file in 128. That byte is changed in its lowest bit, which is at
/// most the last digit of the first coordinate. Empty for all other files. Does not throw.
[[nodiscard]] std::optional<std::string> ply_with_unambiguous_data(
    const std::filesystem::path& file);

}  // namespace pcavr::model
