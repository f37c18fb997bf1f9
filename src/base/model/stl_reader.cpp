// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/raw_bytes.hpp"

#include "base/model/byte_reader.hpp"
#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_readers.hpp"
#include "base/model/vertex_table.hpp"

namespace pcavr::model {
namespace {

constexpr std::size_t kStlHeader = 84;    // bytes: 80 of any text, and the count
constexpr std::size_t kStlTriangle = 50;  // bytes: normal and corners as floats, two of attributes

/// Welds equal corners while triangles are appended.
class StlMesh {
 public:
  explicit StlMesh(std::size_t triangles) : table_(triangles / 2) {
    mesh_.triangles.reserve(triangles);
  }

  void append(const std::array<Eigen::Vector3f, 3>& corners) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = index_of(corners[k]);
    mesh_.triangles.push_back(triangle);
  }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t index_of(const Eigen::Vector3f& p) {
    const auto next = static_cast<std::uint32_t>(mesh_.vertices.size());
    const std::uint32_t index = table_.find_or_insert(
        hash_of(p), next, [&](std::uint32_t v) { return is_identical(mesh_.vertices[v], p); },
        [&](std::uint32_t v) { return hash_of(mesh_.vertices[v]); });
    if (index == next) mesh_.vertices.push_back(p);
    return index;
  }

  TriangleMesh mesh_;
  VertexTable table_;
};

TriangleMesh read_binary_stl(ByteReader& bytes) {
  if (bytes.remaining() < kStlHeader) throw MeshFault("it is too short for an STL");
  const auto count = load_value<std::uint32_t>(bytes.take(kStlHeader), 80);
  const std::uintmax_t room = bytes.remaining() / kStlTriangle;
  if (count > room) {
    throw MeshFault("its header declares " + std::to_string(count) +
                    " triangles, and the file has room for " + std::to_string(room));
  }
  StlMesh mesh(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const char* triangle = bytes.take(kStlTriangle);
    std::array<Eigen::Vector3f, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      std::memcpy(corners[k].data(), triangle + 12 * (k + 1), 12);
    }
    mesh.append(corners);
  }
  return mesh.take();
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

/// "vertex" and three numbers.
Eigen::Vector3f stl_corner(const std::vector<std::string_view>& words, int line) {
  Eigen::Vector3f corner;
  if (words.size() != 4) throw MeshFault("a vertex has not three coordinates", line);
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = words[static_cast<std::size_t>(axis) + 1];
    const std::optional<double> number = number_of(word);
    if (!number) {
      throw MeshFault("'" + std::string(word.substr(0, 30)) + "' is not a number", line);
    }
    corner[axis] = static_cast<float>(*number);
  }
  return corner;
}

TriangleMesh read_text_stl(ByteReader& bytes) {
  StlMesh mesh(0);
  std::array<Eigen::Vector3f, 3> corners;
  std::size_t count = 0;
  std::vector<std::string_view> words;
  while (const auto line = bytes.line()) {
    split_words(*line, words);
    const std::string keyword = words.empty() ? "" : lower_case(words[0]);
    const int number = bytes.line_number();
    if (keyword == "vertex") {
      if (count == 3) throw MeshFault("a facet has more than three corners", number);
      corners[count++] = stl_corner(words, number);
    } else if (keyword == "endfacet") {
      if (count != 3) throw MeshFault("a facet has fewer than three corners", number);
      mesh.append(corners);
      count = 0;
    } else if (!keyword.empty() && keyword != "facet" && keyword != "outer" &&
               keyword != "endloop" && keyword != "solid" && keyword != "endsolid") {
      throw MeshFault("'" + keyword.substr(0, 30) + "' is not a keyword of an STL", number);
    }
  }
  if (count > 0)
    throw MeshFault("it is truncated: its last facet does not end", bytes.line_number());
  return mesh.take();
}

/// The header of a binary STL may begin with "solid", too.
bool is_text_stl(ByteReader& bytes) {
  const std::uintmax_t size = bytes.remaining();
  constexpr std::size_t kSearched = 64U << 10U;  // bytes: a name is shorter
  const std::string start = lower_case(bytes.peek(kSearched));
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  if (first == start.npos || start.compare(first, 5, "solid") != 0) return false;
  if (start.size() >= kStlHeader) {
    const auto count = load_value<std::uint32_t>(bytes.peek(kStlHeader).data(), 80);
    if (size == kStlHeader + std::uintmax_t{kStlTriangle} * count) return false;
  }
  return start.find("facet") != start.npos || start.find("endsolid") != start.npos;
}

}  // namespace

TriangleMesh read_stl_mesh(const std::filesystem::path& file) {
  ByteReader bytes(file);
  return is_text_stl(bytes) ? read_text_stl(bytes) : read_binary_stl(bytes);
}

}  // namespace pcavr::model
