// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace pcavr::model {

/// Why a mesh file can't hold what it declares, if so: more vertices, faces or bytes than the file
/// has room for, a header that never ends, or a glTF document that nests without end. Read before
/// anything is made as large as a header says; assimp would allocate first, count for minutes, or
/// run out of stack.
/// `extension` is in lower case, with the dot.
[[nodiscard]] std::optional<std::string> contradicted_size(const std::filesystem::path& file,
                                                           const std::string& extension);

}  // namespace pcavr::model
