// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// A level of detail in base: its file's axes are a viewer's (glTF: y up).
[[nodiscard]] Expected<TriangleMesh> read_scene_level(const std::filesystem::path& file);

}  // namespace pcavr
