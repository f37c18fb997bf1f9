// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// A binary glTF file with its meshes compressed (EXT_meshopt_compression) by gltfpack, which runs
/// as a child process in a temporary folder that is removed afterwards. Names and coordinates are
/// kept exactly, colours to 12 bits. An Error if gltfpack is missing, fails, or takes longer than
/// `timeout` [s]. Thread-safe.
[[nodiscard]] Expected<std::string> packed_mesh(const std::string& glb, double timeout);

}  // namespace pcavr
