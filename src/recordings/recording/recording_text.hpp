// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// A stamp for lists and file names: six decimals, or nine where six would round it.
[[nodiscard]] std::string format_file_stamp(Stamp stamp);
/// A field of a list, quoted where it contains whitespace or other special characters.
[[nodiscard]] std::string quoted_field(const std::string& field);
/// The texts of a recording's files (serialisation), from which the parsers read the same values.
[[nodiscard]] std::string format_tool(const Trajectory& T_base_tool);
[[nodiscard]] std::string format_wrench(const std::vector<WrenchSample>& wrench);
/// Wavefront OBJ with normals where the mesh has them.
[[nodiscard]] std::string format_obj(const TriangleMesh& mesh);

}  // namespace pcavr
