// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "pcavr/base/core/output.hpp"

namespace pcavr {

/// "scene.yaml" for a scene.
[[nodiscard]] std::string_view manifest_name(OutputKind kind);
/// Whether a file of this name is the manifest of any kind.
[[nodiscard]] bool is_manifest_name(std::string_view file_name);

/// Fails unless the folder contains the manifest of an output of this kind, and otherwise only
/// what pcavr writes there: files of the user are never replaced.
[[nodiscard]] Expected<void> check_replaceable(const std::filesystem::path& folder,
                                               OutputKind kind);

/// Whether this entry is ignored in a folder whose content is replaced: what a file system creates
/// itself (lost+found), and the temporary folders of pcavr.
[[nodiscard]] bool is_ignored_entry(std::string_view name);

}  // namespace pcavr
