// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <string_view>

#include "pcavr/core/output.hpp"

#include "bytes.hpp"
#include "glb_file.hpp"
#include "glb_format.hpp"

namespace pcavr {
namespace {

using nlohmann::json;

/// Why a file is not read; never leaves read_parts. JSON's own exceptions are caught there, too.
class InvalidGlb : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Chunks {
  json document;
  std::string_view buffer;
};

Chunks chunks_of(std::string_view bytes) {
  const auto number = [&](std::size_t at) { return value_at<std::uint32_t>(bytes.data(), at); };
  constexpr std::size_t kHeader = 20;
  if (bytes.size() < kHeader || number(0) != kGlbMagic || number(4) != 2) {
    throw InvalidGlb("is not a binary glTF 2.0 file");
  }
  const std::size_t text_size = number(12);
  if (number(8) != bytes.size() || text_size > bytes.size() - kHeader) {
    throw InvalidGlb("differs in size from its header");
  }
  Chunks chunks{json::parse(bytes.substr(kHeader, text_size)), bytes.substr(kHeader + text_size)};
  if (chunks.buffer.empty()) return chunks;
  const std::size_t at = kHeader + text_size;
  if (chunks.buffer.size() < 8 || number(at + 4) != kGlbBinaryChunk ||
      number(at) != chunks.buffer.size() - 8) {
    throw InvalidGlb("has a binary part that differs in size from its header");
  }
  chunks.buffer.remove_prefix(8);
  return chunks;
}

/// The bytes of an accessor with `element_size` bytes for each element.
std::string_view elements(const Chunks& chunks, const json& accessor, std::size_t element_size) {
  const json& view =
      chunks.document.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  const auto offset = view.at("byteOffset").get<std::size_t>();
  const auto length = view.at("byteLength").get<std::size_t>();
  const auto count = accessor.at("count").get<std::size_t>();
  if (offset > chunks.buffer.size() || length > chunks.buffer.size() - offset ||
      count > length / element_size) {
    throw InvalidGlb("has an accessor that leaves its buffer");
  }
  return chunks.buffer.substr(offset, count * element_size);
}

std::size_t triangles_of(const Chunks& chunks, std::size_t mesh) {
  const json& primitive = chunks.document.at("meshes").at(mesh).at("primitives").at(0);
  const auto accessor_at = [&](const json& number) -> const json& {
    return chunks.document.at("accessors").at(number.get<std::size_t>());
  };
  const json& attributes = primitive.at("attributes");
  const auto vertices = accessor_at(attributes.at("POSITION")).at("count").get<std::size_t>();
  (void)elements(chunks, accessor_at(attributes.at("POSITION")), 3 * sizeof(float));
  (void)elements(chunks, accessor_at(attributes.at("NORMAL")), 3 * sizeof(float));
  const std::string_view indices =
      elements(chunks, accessor_at(primitive.at("indices")), sizeof(std::uint32_t));
  for (std::size_t at = 0; at < indices.size(); at += sizeof(std::uint32_t)) {
    if (value_at<std::uint32_t>(indices.data(), at) >= vertices) {
      throw InvalidGlb("has an index without a vertex");
    }
  }
  return indices.size() / (3 * sizeof(std::uint32_t));
}

Pose pose_of(const json& node) {
  const auto t = node.at("translation").get<std::array<double, 3>>();
  const auto q = node.at("rotation").get<std::array<double, 4>>();
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) throw InvalidGlb("has a rotation that is none");
  return Pose(rotation, Eigen::Vector3d(t[0], t[1], t[2]));
}

GlbContent content_of(const Chunks& chunks) {
  const json& document = chunks.document;
  const json& root =
      document.at("nodes").at(document.at("scenes").at(0).at("nodes").at(0).get<std::size_t>());
  GlbContent content;
  content.root = root.at("name").get<std::string>();
  content.T_viewer_root = pose_of(root);
  for (const json& number : root.value("children", json::array())) {
    const json& node = document.at("nodes").at(number.get<std::size_t>());
    content.nodes.push_back({node.at("name").get<std::string>(), pose_of(node),
                             triangles_of(chunks, node.at("mesh").get<std::size_t>())});
  }
  return content;
}

StaticMeshGlb static_mesh_of(Chunks chunks) {
  json& document = chunks.document;
  for (const json& node : document.at("nodes")) {
    if (node.at("name") != "static_mesh") continue;
    const auto mesh = node.at("mesh").get<std::size_t>();
    const std::size_t triangles = triangles_of(chunks, mesh);
    document["nodes"] = json::array({{{"name", "static_mesh"}, {"mesh", mesh}}});
    document["scenes"] = json::array({{{"nodes", json::array({0})}}});
    return {assemble_glb(document, chunks.buffer), triangles};
  }
  return {};
}

/// What `make` makes of a file's parts; its faults as Errors.
template <typename Result, typename Make>
Expected<Result> read_parts(const std::filesystem::path& file, Make make) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  try {
    return make(chunks_of(*bytes));
  } catch (const InvalidGlb& invalid) {
    return Error{.message = invalid.what(), .file = file.string()};
  } catch (const json::exception&) {
    return Error{.message = "lacks a part of a scene's glTF, or has it in another form",
                 .file = file.string()};
  }
}

}  // namespace

Expected<GlbContent> read_glb(const std::filesystem::path& file) {
  return read_parts<GlbContent>(file, content_of);
}

Expected<StaticMeshGlb> read_static_mesh_glb(const std::filesystem::path& file) {
  return read_parts<StaticMeshGlb>(file, static_mesh_of);
}

}  // namespace pcavr
