// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/shape_file.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "model/mesh_file.hpp"
#include "model/polygon.hpp"
#include "model/vertex_table.hpp"

namespace pcavr::model {
namespace fs = std::filesystem;
namespace {

// Files from this size are streamed, because assimp would need much memory and time [bytes]: some
// 100 000 triangles.
constexpr std::uintmax_t kLargeFile = 8U << 20U;
constexpr std::size_t kChunk = 1U << 20U;  // bytes per read
// Indices are 32 bits; the largest value is reserved for "none".
constexpr std::uint64_t kMaxVertices = 0xFFFFFFFEU;

static_assert(std::endian::native == std::endian::little,
              "binary meshes are read without byte swapping");

template <typename Number>
Number number_at(const char* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return number;
}

/// Buffered reader of a file.
class ByteReader {
 public:
  explicit ByteReader(const fs::path& file) : stream_(file, std::ios::binary) {}

  /// The next `count` bytes, valid until the next call; null if the file ends before.
  const char* take(std::size_t count) {
    if (end_ - next_ < count) refill(count);
    if (end_ - next_ < count) return nullptr;
    const char* bytes = buffer_.data() + next_;
    next_ += count;
    return bytes;
  }
  /// The next line without its end (LF or CR LF), valid until the next call; nothing at the end.
  std::optional<std::string_view> line() {
    std::size_t searched = 0;
    for (;;) {
      const char* begin = buffer_.data() + next_;
      const std::size_t size = end_ - next_;
      const void* found =
          size > searched ? std::memchr(begin + searched, '\n', size - searched) : nullptr;
      if (found != nullptr || (is_at_end_ && size > 0)) {
        std::size_t length = size;
        if (found != nullptr) {
          length = static_cast<std::size_t>(static_cast<const char*>(found) - begin);
        }
        next_ += length + (found != nullptr ? 1 : 0);
        std::string_view text(begin, length);
        if (text.ends_with('\r')) text.remove_suffix(1);
        return text;
      }
      if (is_at_end_) return std::nullopt;
      searched = size;
      refill(size + 1);
    }
  }

 private:
  void refill(std::size_t min_size) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(next_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= next_;
    next_ = 0;
    buffer_.resize(std::max(buffer_.size(), min_size + kChunk));
    stream_.read(buffer_.data() + end_, static_cast<std::streamsize>(buffer_.size() - end_));
    end_ += static_cast<std::size_t>(stream_.gcount());
    is_at_end_ = !stream_;
  }

  std::ifstream stream_;
  std::vector<char> buffer_;
  std::size_t next_ = 0;
  std::size_t end_ = 0;
  bool is_at_end_ = false;
};

void append_face(const std::vector<std::uint32_t>& corners, TriangleMesh& mesh) {
  if (corners.size() == 3) {
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
  } else {
    append_polygon(corners, mesh);
  }
}

std::string extension_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// ---- STL: 80 bytes of header, a count, then 50 bytes a triangle: normal, corners, two bytes.

constexpr std::size_t kStlHeader = 84;    // 80 bytes of text and the count
constexpr std::size_t kStlTriangle = 50;  // 12 floats and 2 bytes of attributes

std::optional<TriangleMesh> read_stl(const fs::path& file, std::uintmax_t size) {
  ByteReader bytes(file);
  const char* header = bytes.take(kStlHeader);
  if (header == nullptr) return std::nullopt;
  const auto count = number_at<std::uint32_t>(header + 80);
  if (size != kStlHeader + std::uintmax_t{kStlTriangle} * count) return std::nullopt;
  TriangleMesh mesh;
  mesh.triangles.reserve(count);
  VertexTable table(count / 2);
  const auto rehash = [&](std::uint32_t v) { return hash_of(mesh.vertices[v]); };
  for (std::uint32_t i = 0; i < count; ++i) {
    const char* triangle = bytes.take(kStlTriangle);
    if (triangle == nullptr) return std::nullopt;
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      Eigen::Vector3f p;
      std::memcpy(p.data(), triangle + 12 * (k + 1), 12);
      if (!p.allFinite()) return std::nullopt;
      const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
      corners[k] = table.find_or_insert(
          hash_of(p), next, [&](std::uint32_t v) { return is_identical(mesh.vertices[v], p); },
          rehash);
      if (corners[k] == next) mesh.vertices.push_back(p);
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

// ---- PLY, binary little-endian: a header that names the properties, then rows.

/// Bytes of a PLY number type; 0 for an unknown one.
std::size_t size_of(std::string_view type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "int32" || type == "uint32") return 4;
  if (type == "float" || type == "float32") return 4;
  if (type == "double" || type == "float64") return 8;
  return 0;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == line.npos) return words;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

/// The PLY layout that this reader supports: rows of numbers with x, y, z as floats, then faces
/// with one list of 32-bit indices.
struct PlyLayout {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  std::size_t vertex_bytes = 0;
  std::array<std::size_t, 3> offsets{};  ///< of x, y and z in a vertex's row
  std::size_t count_bytes = 0;           ///< of a face's number of corners
  bool has_position = false;
  bool has_faces = false;
};

/// Parses one line of the header. False: not supported by this reader.
bool parse_header_line(const std::vector<std::string_view>& words, PlyLayout& layout, int& axes) {
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return true;
  if (words[0] == "element" && words.size() == 3) {
    const bool is_vertex = words[1] == "vertex" && layout.vertex_bytes == 0 && !layout.has_faces;
    const bool is_face = words[1] == "face" && !layout.has_faces && layout.vertex_bytes > 0;
    std::uint64_t& count = is_vertex ? layout.vertices : layout.faces;
    const auto [end, code] = std::from_chars(words[2].begin(), words[2].end(), count);
    layout.has_faces = layout.has_faces || is_face;
    return (is_vertex || is_face) && code == std::errc{} && end == words[2].end();
  }
  if (words[0] != "property") return false;
  if (words.size() == 5 && words[1] == "list") {
    const bool is_first = layout.has_faces && layout.count_bytes == 0;
    layout.count_bytes = size_of(words[2]);
    const bool is_count = layout.count_bytes == 1 || layout.count_bytes == 4;
    return is_first && is_count && size_of(words[3]) == 4 &&
           words[3].find("float") == words[3].npos;
  }
  if (words.size() != 3 || layout.has_faces || size_of(words[1]) == 0) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (words[2] != std::string_view("xyz").substr(axis, 1)) continue;
    if (words[1] != "float" && words[1] != "float32") return false;
    layout.offsets[axis] = layout.vertex_bytes;
    ++axes;
  }
  layout.vertex_bytes += size_of(words[1]);
  layout.has_position = axes == 3;
  return true;
}

std::optional<PlyLayout> read_ply_header(ByteReader& bytes) {
  const auto is_line = [&](std::string_view text) {
    const auto line = bytes.line();
    return line && *line == text;
  };
  if (!is_line("ply") || !is_line("format binary_little_endian 1.0")) return std::nullopt;
  PlyLayout layout;
  int axes = 0;
  constexpr int kMaxLines = 200;  // of a header
  for (int i = 0; i < kMaxLines; ++i) {
    const auto line = bytes.line();
    if (!line) return std::nullopt;
    if (*line == "end_header") {
      const bool is_known = layout.has_position && layout.count_bytes > 0;
      return is_known ? std::optional(layout) : std::nullopt;
    }
    if (!parse_header_line(words_of(*line), layout, axes)) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<TriangleMesh> read_ply(const fs::path& file, std::uintmax_t size) {
  ByteReader bytes(file);
  const std::optional<PlyLayout> layout = read_ply_header(bytes);
  if (!layout) return std::nullopt;
  // Never reserve more than the file can contain.
  if (layout->vertices > size / layout->vertex_bytes || layout->vertices > kMaxVertices ||
      layout->faces > size / (layout->count_bytes + 12)) {
    return std::nullopt;
  }
  TriangleMesh mesh;
  mesh.vertices.reserve(layout->vertices);
  mesh.triangles.reserve(layout->faces);
  for (std::uint64_t i = 0; i < layout->vertices; ++i) {
    const char* row = bytes.take(layout->vertex_bytes);
    if (row == nullptr) return std::nullopt;
    const auto& [x, y, z] = layout->offsets;
    mesh.vertices.emplace_back(number_at<float>(row + x), number_at<float>(row + y),
                               number_at<float>(row + z));
    if (!mesh.vertices.back().allFinite()) return std::nullopt;
  }
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < layout->faces; ++i) {
    const char* head = bytes.take(layout->count_bytes);
    if (head == nullptr) return std::nullopt;
    const std::uint32_t count =
        layout->count_bytes == 1 ? number_at<std::uint8_t>(head) : number_at<std::uint32_t>(head);
    if (count > layout->vertices) return std::nullopt;
    const char* indices = bytes.take(4 * std::size_t{count});
    if (indices == nullptr) return std::nullopt;
    corners.resize(count);
    for (std::uint32_t k = 0; k < count; ++k) {
      corners[k] = number_at<std::uint32_t>(indices + 4 * std::size_t{k});
      if (corners[k] >= mesh.vertices.size()) return std::nullopt;
    }
    append_face(corners, mesh);
  }
  return mesh;
}

// ---- OBJ: v and f; normals, texture coordinates and materials are ignored.

bool parse_vertex(std::string_view text, TriangleMesh& mesh) {
  Eigen::Vector3f p;
  const char* at = text.data();
  const char* end = at + text.size();
  for (int axis = 0; axis < 3; ++axis) {
    while (at < end && (*at == ' ' || *at == '\t')) ++at;
    if (at < end && *at == '+') ++at;
    const auto [next, code] = std::from_chars(at, end, p[axis]);
    if (code != std::errc{} || (next < end && *next != ' ' && *next != '\t')) return false;
    at = next;
  }
  // A fourth number alone is a weight; three more are a colour.
  const std::size_t more = words_of({at, static_cast<std::size_t>(end - at)}).size();
  if (more == 1 || !p.allFinite() || mesh.vertices.size() >= kMaxVertices) return false;
  mesh.vertices.push_back(p);
  return true;
}

bool parse_face(std::string_view text, std::vector<std::uint32_t>& corners, TriangleMesh& mesh) {
  corners.clear();
  const char* at = text.data();
  const char* end = at + text.size();
  for (;;) {
    while (at < end && (*at == ' ' || *at == '\t')) ++at;
    if (at == end) break;
    std::int64_t index = 0;
    const auto [next, code] = std::from_chars(at, end, index);
    const auto count = static_cast<std::int64_t>(mesh.vertices.size());
    // One-based; negative: relative to the last vertex.
    if (index < 0) index += count + 1;
    if (code != std::errc{} || index < 1 || index > count) return false;
    corners.push_back(static_cast<std::uint32_t>(index - 1));
    at = next;
    while (at < end && *at != ' ' && *at != '\t') ++at;  // texture and normal indices
  }
  append_face(corners, mesh);
  return true;
}

std::optional<TriangleMesh> read_obj(const fs::path& file) {
  ByteReader bytes(file);
  TriangleMesh mesh;
  std::vector<std::uint32_t> corners;
  while (const auto line = bytes.line()) {
    if (line->ends_with('\\')) return std::nullopt;  // line continuation
    if (line->starts_with("v ")) {
      if (!parse_vertex(line->substr(2), mesh)) return std::nullopt;
    } else if (line->starts_with("f ")) {
      if (!parse_face(line->substr(2), corners, mesh)) return std::nullopt;
    } else {
      const std::string_view word = line->substr(0, line->find_first_of(" \t"));
      constexpr std::array<std::string_view, 10> kIgnored = {"",  "vn", "vt",     "g",      "o",
                                                             "s", "#",  "usemtl", "mtllib", "l"};
      const bool is_known = word.starts_with('#') ||
                            std::find(kIgnored.begin(), kIgnored.end(), word) != kIgnored.end();
      if (!is_known) return std::nullopt;
    }
  }
  return mesh;
}

}  // namespace

std::optional<TriangleMesh> read_shape(const fs::path& file) {
  std::error_code code;
  const std::uintmax_t size = fs::file_size(file, code);
  if (code) return std::nullopt;
  const std::string extension = extension_of(file);
  if (extension == ".stl") return read_stl(file, size);
  if (extension == ".ply") return read_ply(file, size);
  if (extension == ".obj") return read_obj(file);
  return std::nullopt;
}

Expected<TriangleMesh> import_shape(const fs::path& file) {
  std::error_code code;
  const bool is_large = fs::is_regular_file(file, code) && fs::file_size(file, code) >= kLargeFile;
  if (is_large && !code) {
    std::optional<TriangleMesh> mesh = read_shape(file);
    if (mesh && !mesh->triangles.empty()) return *std::move(mesh);
  }
  return import_mesh(file);
}

}  // namespace pcavr::model
