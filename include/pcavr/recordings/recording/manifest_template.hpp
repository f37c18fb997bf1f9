// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

/// The markers, objects, tool and robot of a recording.yaml that an import takes over, without its
/// camera; an empty manifest where `file` is empty. Errors as of parse_manifest. Thread-safe.
[[nodiscard]] Expected<Manifest> read_manifest_template(const std::filesystem::path& file);

/// Copies the files that the manifest names, meshes and robot, from one recording's folder to
/// another's. Fails where one can't be read or written.
[[nodiscard]] Expected<void> copy_manifest_files(const Manifest& manifest,
                                                 const std::filesystem::path& from,
                                                 const std::filesystem::path& target);

}  // namespace pcavr
