// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/geometry/pixel.hpp"

#include "base/model/byte_reader.hpp"
#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_readers.hpp"
#include "base/model/ply_header.hpp"

namespace pcavr::model {
namespace {

static_assert(std::endian::native == std::endian::little);

template <typename Number>
double load_ply(const char* bytes, bool is_big_endian) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, sizeof(Number));
  if (is_big_endian) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<Number>(raw));
}

double load_ply(const char* bytes, PlyNumber type, bool is_big_endian) {
  switch (type) {
    case PlyNumber::kInt8:
      return load_ply<std::int8_t>(bytes, is_big_endian);
    case PlyNumber::kUint8:
      return load_ply<std::uint8_t>(bytes, is_big_endian);
    case PlyNumber::kInt16:
      return load_ply<std::int16_t>(bytes, is_big_endian);
    case PlyNumber::kUint16:
      return load_ply<std::uint16_t>(bytes, is_big_endian);
    case PlyNumber::kInt32:
      return load_ply<std::int32_t>(bytes, is_big_endian);
    case PlyNumber::kUint32:
      return load_ply<std::uint32_t>(bytes, is_big_endian);
    case PlyNumber::kFloat:
      return load_ply<float>(bytes, is_big_endian);
    default:
      return load_ply<double>(bytes, is_big_endian);
  }
}

/// The numbers of each property of a row: one, or those of a list.
using PlyRow = std::vector<std::vector<double>>;

/// Reads the rows that follow a header.
class PlyRowReader {
 public:
  PlyRowReader(ByteReader& bytes, PlyFormat format) : bytes_(bytes), format_(format) {}

  void read(const PlyElement& element, PlyRow& row) {
    row.resize(element.properties.size());
    if (format_ == PlyFormat::kText && !element.properties.empty()) next_line(element);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      const std::size_t count = property.count_type ? list_length(element, property) : 1;
      read_numbers(element, property.type, count, row[i]);
    }
    if (format_ == PlyFormat::kText && next_word_ != words_.size()) fail_row(element);
  }
  [[nodiscard]] int line() const { return format_ == PlyFormat::kText ? bytes_.line_number() : 0; }

 private:
  [[noreturn]] void fail_row(const PlyElement& element) const {
    throw MeshFault("a row of " + element.name + " has not one number for each property", line());
  }

  void next_line(const PlyElement& element) {
    next_word_ = 0;
    do {
      const auto text = bytes_.line();
      if (!text) throw MeshFault("it is truncated: rows of " + element.name + " are missing");
      split_words(*text, words_);
    } while (words_.empty());
  }

  std::size_t list_length(const PlyElement& element, const PlyProperty& property) {
    read_numbers(element, *property.count_type, 1, length_);
    // In a binary file, later calls of read_numbers check the length against the bytes that are
    // left.
    const double length = length_[0];
    if (!(length >= 0.0 && length <= 4294967295.0 && length == std::floor(length))) {
      throw MeshFault("a list of " + element.name + " has a length that is no count", line());
    }
    return static_cast<std::size_t>(length);
  }

  void read_numbers(const PlyElement& element, PlyNumber type, std::size_t count,
                    std::vector<double>& numbers) {
    numbers.clear();
    if (format_ != PlyFormat::kText) {
      const std::size_t size = size_of(type);
      const char* bytes = bytes_.take(size * count);
      for (std::size_t i = 0; i < count; ++i) {
        numbers.push_back(load_ply(bytes + i * size, type, format_ == PlyFormat::kBigEndian));
      }
      return;
    }
    if (count > words_.size() - next_word_) fail_row(element);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view word = words_[next_word_++];
      const std::optional<double> number = number_of(word);
      if (!number) {
        throw MeshFault("'" + std::string(word.substr(0, 30)) + "' is not a number", line());
      }
      numbers.push_back(*number);
    }
  }

  ByteReader& bytes_;
  PlyFormat format_;
  std::vector<std::string_view> words_;
  std::size_t next_word_ = 0;
  std::vector<double> length_;
};

/// The places of three properties in a row.
using PlyTriple = std::array<std::size_t, 3>;

std::optional<std::size_t> find_property(const PlyElement& element, std::string_view name) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (element.properties[i].name == name) return i;
  }
  return std::nullopt;
}

std::optional<PlyTriple> find_numbers(const PlyElement& element,
                                      const std::array<const char*, 3>& names) {
  PlyTriple triple{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::optional<std::size_t> index = find_property(element, names[k]);
    if (!index || element.properties[*index].count_type) return std::nullopt;
    triple[k] = *index;
  }
  return triple;
}

/// The factor that scales a channel's largest value to 255; nothing for a type of which no exporter
/// writes colours.
std::optional<double> channel_scale(PlyNumber type) {
  if (type == PlyNumber::kUint8) return 1.0;
  if (type == PlyNumber::kUint16) return 1.0 / 257.0;
  return type >= PlyNumber::kFloat ? std::optional(255.0) : std::nullopt;
}

class PlyMeshReader {
 public:
  explicit PlyMeshReader(const std::filesystem::path& file)
      : bytes_(file), header_(read_ply_header(bytes_)), rows_(bytes_, header_.format) {}

  TriangleMesh read() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else if (element.name == "tristrips") {
        read_strips(element);
      } else {
        for (std::uint64_t i = 0; i < element.count; ++i) rows_.read(element, row_);
      }
    }
    return std::move(mesh_);
  }

 private:
  void read_vertices(const PlyElement& element) {
    const auto position = find_numbers(element, {"x", "y", "z"});
    if (!position) throw MeshFault("its vertices have no properties x, y and z");
    if (element.count >= 0xFFFFFFFFU) throw MeshFault("it has too many vertices");
    const auto normal = find_numbers(element, {"nx", "ny", "nz"});
    auto color = find_numbers(element, {"red", "green", "blue"});
    if (!color) color = find_numbers(element, {"diffuse_red", "diffuse_green", "diffuse_blue"});
    const std::optional<double> scale =
        color ? channel_scale(element.properties[(*color)[0]].type) : std::nullopt;
    mesh_.vertices.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      rows_.read(element, row_);
      mesh_.vertices.push_back(vector_at(*position).cast<float>());
      if (normal) mesh_.normals.push_back(vector_at(*normal).cast<float>().normalized());
      if (scale) mesh_.colors.push_back(color_of(*scale * vector_at(*color)));
    }
  }

  [[nodiscard]] Eigen::Vector3d vector_at(const PlyTriple& triple) const {
    return {row_[triple[0]][0], row_[triple[1]][0], row_[triple[2]][0]};
  }

  static Rgb8 color_of(const Eigen::Vector3d& color) {
    const auto channel = [](double c) {
      return static_cast<std::uint8_t>(clamp_to_int(c + 0.5, 0, 255));
    };
    return {channel(color.x()), channel(color.y()), channel(color.z())};
  }

  /// The list of vertices in a row of faces or strips.
  static std::size_t index_list(const PlyElement& element) {
    for (const char* name : {"vertex_indices", "vertex_index"}) {
      const std::optional<std::size_t> found = find_property(element, name);
      if (found && element.properties[*found].count_type) return *found;
    }
    throw MeshFault("its element " + element.name + " has no list vertex_indices");
  }

  [[nodiscard]] std::uint32_t vertex_of(double index) const {
    if (!(index >= 0.0 && index < static_cast<double>(mesh_.vertices.size()) &&
          index == std::floor(index))) {
      throw MeshFault("a face refers to a vertex out of range of the " +
                          std::to_string(mesh_.vertices.size()) + " before it",
                      rows_.line());
    }
    return static_cast<std::uint32_t>(index);
  }

  void read_faces(const PlyElement& element) {
    if (element.count == 0) return;
    const std::size_t list = index_list(element);
    mesh_.triangles.reserve(element.count);
    std::vector<std::uint32_t> corners;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      rows_.read(element, row_);
      corners.clear();
      for (const double index : row_[list]) corners.push_back(vertex_of(index));
      append_face(corners, rows_.line(), mesh_);
    }
  }

  /// Each vertex makes a triangle with the two before it, every other one turned; -1 begins anew.
  void read_strips(const PlyElement& element) {
    if (element.count == 0) return;
    const std::size_t list = index_list(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      rows_.read(element, row_);
      std::vector<std::uint32_t> strip;
      for (const double index : row_[list]) {
        if (index == -1.0) {
          strip.clear();
          continue;
        }
        strip.push_back(vertex_of(index));
        const std::size_t n = strip.size();
        if (n < 3) continue;
        const bool is_turned = n % 2 == 0;
        mesh_.triangles.push_back(
            {strip[n - (is_turned ? 2 : 3)], strip[n - (is_turned ? 3 : 2)], strip[n - 1]});
      }
    }
  }

  ByteReader bytes_;
  PlyHeader header_;
  PlyRowReader rows_;
  PlyRow row_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh read_ply_mesh(const std::filesystem::path& file) { return PlyMeshReader(file).read(); }

}  // namespace pcavr::model
