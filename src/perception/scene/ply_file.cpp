// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/ply_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_parts.hpp"
#include "pcavr/base/core/raw_bytes.hpp"

#include "ply_parts.hpp"

namespace pcavr {
namespace {

constexpr char kHeaderStart[] =
    "ply\nformat binary_little_endian 1.0\ncomment coordinates in metres\n";
constexpr char kNormals[] = "property float nx\nproperty float ny\nproperty float nz\n";
constexpr char kColors[] = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
constexpr char kFaces[] = "property list uchar int vertex_indices\n";

constexpr std::size_t kVectorBytes = 3 * sizeof(float);
constexpr std::size_t kColorBytes = 3;  // uchar red, green, blue
constexpr std::size_t kTriangleBytes = 1 + 3 * sizeof(std::int32_t);

struct Layout {
  std::size_t vertices = 0;
  std::optional<std::size_t> triangles = {};  ///< nullopt: a point cloud
  bool has_normals = false;
  bool has_colors = false;

  [[nodiscard]] std::string header() const {
    std::string text = kHeaderStart + ("element vertex " + std::to_string(vertices)) +
                       "\nproperty float x\nproperty float y\nproperty float z\n";
    if (has_normals) text += kNormals;
    if (has_colors) text += kColors;
    if (triangles) text += "element face " + std::to_string(*triangles) + '\n' + kFaces;
    return text + "end_header\n";
  }
  [[nodiscard]] std::size_t vertex_bytes() const {
    return kVectorBytes * (has_normals ? 2 : 1) + (has_colors ? kColorBytes : 0);
  }
  [[nodiscard]] std::size_t content_bytes() const {
    return vertices * vertex_bytes() + triangles.value_or(0) * kTriangleBytes;
  }
};

void append(std::string& bytes, const Eigen::Vector3f& vector) {
  for (const float number : vector) append_bytes(bytes, number);
}

/// Rows of a file, begin <= i < end.
struct IndexRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::string vertex_rows(const Layout& layout, const std::vector<Eigen::Vector3f>& points,
                        const std::vector<Eigen::Vector3f>& normals,
                        const std::vector<Rgb8>& colors, IndexRange rows) {
  std::string bytes;
  bytes.reserve((rows.end - rows.begin) * layout.vertex_bytes());
  for (std::size_t i = rows.begin; i < rows.end; ++i) {
    append(bytes, points[i]);
    if (layout.has_normals) append(bytes, normals[i]);
    if (!layout.has_colors) continue;
    for (const std::uint8_t channel : {colors[i].r, colors[i].g, colors[i].b}) {
      append_bytes(bytes, channel);
    }
  }
  return bytes;
}

std::string triangle_rows(const TriangleMesh& mesh, IndexRange rows) {
  std::string bytes;
  bytes.reserve((rows.end - rows.begin) * kTriangleBytes);
  for (std::size_t i = rows.begin; i < rows.end; ++i) {
    append_bytes(bytes, std::uint8_t{3});
    for (const std::uint32_t vertex : mesh.triangles[i]) append_bytes(bytes, vertex);
  }
  return bytes;
}

Layout layout_of(const TriangleMesh& mesh) {
  return {mesh.vertices.size(), mesh.triangles.size(), !mesh.normals.empty(), !mesh.colors.empty()};
}

Layout layout_of(const PointCloud& cloud) {
  return {cloud.points.size(), std::nullopt, !cloud.normals.empty(), !cloud.colors.empty()};
}

/// Rows of one kind, to be formatted part by part.
struct Section {
  std::size_t count = 0;
  std::function<std::string(const IndexRange&)> format;
};

Expected<void> write_sections(const std::filesystem::path& file, const std::string& header,
                              const std::vector<Section>& sections) {
  constexpr std::size_t kRows = 1 << 16;  // of a part: 2 MB
  bool has_header = false;
  std::size_t section = 0;
  std::size_t row = 0;
  return write_file_in_parts(file, [&] {
    if (!std::exchange(has_header, true)) return header;
    while (section < sections.size() && row == sections[section].count) {
      ++section;
      row = 0;
    }
    if (section == sections.size()) return std::string();
    const IndexRange rows{row, std::min(row + kRows, sections[section].count)};
    row = rows.end;
    return sections[section].format(rows);
  });
}

/// Parses a header; nullopt unless it is exactly one that format_ply writes.
std::optional<Layout> parse_layout(const std::string& header) {
  Layout layout;
  std::istringstream lines(header);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream tokens(line);
    std::string keyword;
    std::string element;
    std::size_t count = 0;
    if (!(tokens >> keyword >> element >> count) || keyword != "element") continue;
    if (element == "vertex") layout.vertices = count;
    if (element == "face") layout.triangles = count;
  }
  layout.has_normals = header.find(kNormals) != std::string::npos;
  layout.has_colors = header.find(kColors) != std::string::npos;
  if (layout.header() != header) return std::nullopt;
  return layout;
}

Eigen::Vector3f vector_at(const char* bytes, std::size_t offset) {
  return {load_value<float>(bytes, offset), load_value<float>(bytes, offset + 4),
          load_value<float>(bytes, offset + 8)};
}

void read_vertices(const char* bytes, const Layout& layout, TriangleMesh& mesh) {
  for (std::size_t i = 0; i < layout.vertices; ++i) {
    std::size_t offset = i * layout.vertex_bytes();
    mesh.vertices.push_back(vector_at(bytes, offset));
    offset += kVectorBytes;
    if (layout.has_normals) {
      mesh.normals.push_back(vector_at(bytes, offset));
      offset += kVectorBytes;
    }
    if (layout.has_colors) {
      const auto channel = [&](std::size_t c) {
        return load_value<std::uint8_t>(bytes, offset + c);
      };
      mesh.colors.push_back({channel(0), channel(1), channel(2)});
    }
  }
}

/// False where a face is not a triangle or a vertex index is out of range.
bool read_triangles(const char* bytes, const Layout& layout, TriangleMesh& mesh) {
  for (std::size_t i = 0; i < layout.triangles.value_or(0); ++i) {
    const std::size_t offset = i * kTriangleBytes;
    if (bytes[offset] != 3) return false;
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      triangle[corner] = load_value<std::uint32_t>(bytes, offset + 1 + corner * 4);
      if (triangle[corner] >= layout.vertices) return false;
    }
    mesh.triangles.push_back(triangle);
  }
  return true;
}

}  // namespace

std::string format_ply(const TriangleMesh& mesh) {
  const Layout layout = layout_of(mesh);
  return layout.header() +
         vertex_rows(layout, mesh.vertices, mesh.normals, mesh.colors, {0, layout.vertices}) +
         triangle_rows(mesh, {0, mesh.triangles.size()});
}

std::string format_ply(const PointCloud& cloud) {
  const Layout layout = layout_of(cloud);
  return layout.header() +
         vertex_rows(layout, cloud.points, cloud.normals, cloud.colors, {0, layout.vertices});
}

Expected<void> write_ply(const TriangleMesh& mesh, const std::filesystem::path& file) {
  const Layout layout = layout_of(mesh);
  const auto vertices = [&](const IndexRange& rows) {
    return vertex_rows(layout, mesh.vertices, mesh.normals, mesh.colors, rows);
  };
  const auto triangles = [&](const IndexRange& rows) { return triangle_rows(mesh, rows); };
  return write_sections(file, layout.header(),
                        {{layout.vertices, vertices}, {mesh.triangles.size(), triangles}});
}

Expected<void> write_ply(const PointCloud& cloud, const std::filesystem::path& file) {
  const Layout layout = layout_of(cloud);
  const auto points = [&](const IndexRange& rows) {
    return vertex_rows(layout, cloud.points, cloud.normals, cloud.colors, rows);
  };
  return write_sections(file, layout.header(), {{layout.vertices, points}});
}

Expected<TriangleMesh> read_ply(const std::filesystem::path& file) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  constexpr std::string_view kHeaderEnd = "end_header\n";
  const std::size_t end = bytes->find(kHeaderEnd);
  const std::size_t header_size = end == std::string::npos ? 0 : end + kHeaderEnd.size();
  const std::optional<Layout> layout = parse_layout(bytes->substr(0, header_size));
  if (!layout) {
    return Error{.message = "is not a PLY file of a scene", .file = file.string(), .line = 1};
  }
  // Counts first, so that their products with the sizes do not overflow.
  if (layout->vertices > bytes->size() || layout->triangles.value_or(0) > bytes->size() ||
      bytes->size() != header_size + layout->content_bytes()) {
    return Error{.message = "size differs from the header", .file = file.string()};
  }
  TriangleMesh mesh;
  const char* content = bytes->data() + header_size;
  read_vertices(content, *layout, mesh);
  if (!read_triangles(content + layout->vertices * layout->vertex_bytes(), *layout, mesh)) {
    return Error{.message = "has a face that is not a triangle or has an index out of range",
                 .file = file.string()};
  }
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    if (!vertex.allFinite()) {
      return Error{.message = "has a vertex that is not finite", .file = file.string()};
    }
  }
  return mesh;
}

}  // namespace pcavr
