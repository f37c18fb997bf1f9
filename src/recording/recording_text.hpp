// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/geometry/mesh.hpp"
#include "pcavr/recording/recording.hpp"

namespace pcavr {

/// The shortest decimal that reads back to the same number.
[[nodiscard]] std::string shortest_decimal(double number);
/// A stamp for lists and file names: six decimals, or nine where six would round it.
[[nodiscard]] std::string format_file_stamp(Stamp stamp);
/// A field of a list, in quotes where it holds blanks or what else would be taken for another
/// thing.
[[nodiscard]] std::string quoted_field(const std::string& field);
/// The texts of a recording's files, which the parsers read back to the same values.
[[nodiscard]] std::string format_tool(const Trajectory& T_base_tool);
[[nodiscard]] std::string format_wrench(const std::vector<WrenchSample>& wrench);
/// Wavefront OBJ with normals where the mesh has them.
[[nodiscard]] std::string format_obj(const TriangleMesh& mesh);

}  // namespace pcavr
