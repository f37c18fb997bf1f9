// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace pcavr::model {

/// The bytes that a glTF file's buffer refers to: base64 in the URI, or a regular file in the
/// folder of `file` or below it. Throws MeshFault.
[[nodiscard]] std::string read_gltf_uri(const std::string& uri, const std::filesystem::path& file);

}  // namespace pcavr::model
