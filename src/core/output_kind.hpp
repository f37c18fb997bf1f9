// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "pcavr/core/output.hpp"

namespace pcavr {

/// "scene.yaml" for a scene.
[[nodiscard]] std::string_view manifest_name(OutputKind kind);
/// Whether a file of this name is the manifest of any kind.
[[nodiscard]] bool is_manifest_name(std::string_view file_name);

/// Fails unless the folder holds the manifest of an output of this kind, and beside it only what
/// pcavr writes there: nothing of a user's is ever replaced.
[[nodiscard]] Expected<void> check_replaceable(const std::filesystem::path& folder,
                                               OutputKind kind);

/// Whether a folder that an output goes into in place of another may hold this entry: what a file
/// system makes itself, and the temporary folders of pcavr.
[[nodiscard]] bool is_ignored_entry(std::string_view name);

}  // namespace pcavr
