// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/model/byte_reader.hpp"

namespace pcavr::model {

enum class PlyNumber { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

/// [byte]
[[nodiscard]] std::size_t size_of(PlyNumber type);

struct PlyProperty {
  std::string name;
  PlyNumber type = PlyNumber::kFloat;
  std::optional<PlyNumber> count_type = {};  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties = {};
};

enum class PlyFormat { kText, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyFormat format = PlyFormat::kText;
  std::vector<PlyElement> elements;
};

/// Reads up to the line "end_header". Comments and obj_info may stand on any line. The number of
/// rows that each element declares fits into the bytes that follow. Throws MeshFault.
[[nodiscard]] PlyHeader read_ply_header(ByteReader& bytes);

}  // namespace pcavr::model
