// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace pcavr::model {

/// Checks the sizes declared in a mesh file's header against the file size, before memory is
/// allocated for them. Returns the reason if they do not match: more vertices, faces or bytes than
/// the file has room for, a header without an end, or a glTF or Collada document nested too deeply.
/// assimp would allocate first, loop for minutes, or overflow its stack. `extension` is in lower
/// case, with the dot.
[[nodiscard]] std::optional<std::string> find_size_mismatch(const std::filesystem::path& file,
                                                            const std::string& extension);

}  // namespace pcavr::model
