// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <string_view>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/raw_bytes.hpp"
#include "pcavr/perception/scene/glb_file.hpp"

#include "glb_format.hpp"
#include "perception/scene/glb_writer.hpp"

namespace pcavr {
namespace {

using nlohmann::json;

/// Invalid content of a file; caught in read_chunks, like JSON exceptions.
class InvalidGlb : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Chunks {
  json document;
  std::string_view buffer;
};

Chunks chunks_of(std::string_view bytes) {
  const auto word = [&](std::size_t at) { return load_value<std::uint32_t>(bytes.data(), at); };
  constexpr std::size_t kHeader = 20;  // glTF 2.0, 4.4: file header and first chunk's
  if (bytes.size() < kHeader || word(0) != kGlbMagic || word(4) != 2) {
    throw InvalidGlb("is not a binary glTF 2.0 file");
  }
  const std::size_t text_size = word(12);
  if (word(8) != bytes.size() || text_size > bytes.size() - kHeader) {
    throw InvalidGlb("size differs from the header");
  }
  Chunks chunks{json::parse(bytes.substr(kHeader, text_size)), bytes.substr(kHeader + text_size)};
  if (chunks.buffer.empty()) return chunks;
  const std::size_t at = kHeader + text_size;
  if (chunks.buffer.size() < 8 || word(at + 4) != kGlbBinaryChunk ||
      word(at) != chunks.buffer.size() - 8) {
    throw InvalidGlb("size of the binary chunk differs from its header");
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
    throw InvalidGlb("has an accessor that exceeds its buffer");
  }
  return chunks.buffer.substr(offset, count * element_size);
}

std::size_t triangles_of(const Chunks& chunks, std::size_t mesh) {
  const json& primitive = chunks.document.at("meshes").at(mesh).at("primitives").at(0);
  const auto accessor_at = [&](const json& index) -> const json& {
    return chunks.document.at("accessors").at(index.get<std::size_t>());
  };
  const json& attributes = primitive.at("attributes");
  const auto vertices = accessor_at(attributes.at("POSITION")).at("count").get<std::size_t>();
  (void)elements(chunks, accessor_at(attributes.at("POSITION")), 3 * sizeof(float));
  (void)elements(chunks, accessor_at(attributes.at("NORMAL")), 3 * sizeof(float));
  const std::string_view indices =
      elements(chunks, accessor_at(primitive.at("indices")), sizeof(std::uint32_t));
  for (std::size_t at = 0; at < indices.size(); at += sizeof(std::uint32_t)) {
    if (load_value<std::uint32_t>(indices.data(), at) >= vertices) {
      throw InvalidGlb("has a vertex index out of range");
    }
  }
  return indices.size() / (3 * sizeof(std::uint32_t));
}

Pose pose_of(const json& node) {
  const auto t = node.at("translation").get<std::array<double, 3>>();
  const auto q = node.at("rotation").get<std::array<double, 4>>();
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3))
    throw InvalidGlb("has a rotation that is not a unit quaternion");
  return Pose(rotation, Eigen::Vector3d(t[0], t[1], t[2]));
}

GlbContent content_of(const Chunks& chunks) {
  const json& document = chunks.document;
  const json& root =
      document.at("nodes").at(document.at("scenes").at(0).at("nodes").at(0).get<std::size_t>());
  GlbContent content;
  content.root = root.at("name").get<std::string>();
  content.T_viewer_root = pose_of(root);
  for (const json& index : root.value("children", json::array())) {
    const json& node = document.at("nodes").at(index.get<std::size_t>());
    content.nodes.push_back({node.at("name").get<std::string>(), pose_of(node),
                             triangles_of(chunks, node.at("mesh").get<std::size_t>())});
  }
  return content;
}

/// A mesh of a file as a file of its own, whose buffer has nothing else.
class SeparateMesh {
 public:
  SeparateMesh(const Chunks& chunks, const std::string& node, std::size_t mesh,
               const std::string& texture_uri)
      : chunks_(chunks) {
    const json& from = chunks.document;
    json primitive = from.at("meshes").at(mesh).at("primitives").at(0);
    for (json& accessor : primitive.at("attributes")) keep_accessor(accessor);
    keep_accessor(primitive.at("indices"));
    if (primitive.contains("material")) keep_material(primitive.at("material"), texture_uri);
    for (const char* key : {"asset", "extensionsUsed"}) {
      if (from.contains(key)) document_[key] = from.at(key);
    }
    document_["scene"] = 0;
    document_["scenes"] = json::array({{{"nodes", json::array({0})}}});
    document_["nodes"] = json::array({{{"name", node}, {"mesh", 0}}});
    document_["meshes"] =
        json::array({{{"name", node}, {"primitives", json::array({std::move(primitive)})}}});
    document_["buffers"] = json::array({{{"byteLength", buffer_.size()}}});
  }

  [[nodiscard]] std::string bytes() const { return assemble_glb(document_, buffer_); }
  std::string take_texture() { return std::move(texture_); }

 private:
  [[nodiscard]] std::string_view bytes_of(const json& view) const {
    const auto offset = view.at("byteOffset").get<std::size_t>();
    const auto length = view.at("byteLength").get<std::size_t>();
    if (offset > chunks_.buffer.size() || length > chunks_.buffer.size() - offset) {
      throw InvalidGlb("has a part that exceeds its buffer");
    }
    return chunks_.buffer.substr(offset, length);
  }

  [[nodiscard]] const json& view_at(const json& index) const {
    return chunks_.document.at("bufferViews").at(index.get<std::size_t>());
  }

  /// Copies an accessor with its bytes; `index` becomes its new one.
  void keep_accessor(json& index) {
    json accessor = chunks_.document.at("accessors").at(index.get<std::size_t>());
    json view = view_at(accessor.at("bufferView"));
    const std::string_view bytes = bytes_of(view);
    view["byteOffset"] = buffer_.size();
    buffer_ += bytes;
    buffer_.resize((buffer_.size() + 3) / 4 * 4);  // glTF 2.0, 3.6.2.4: aligned to 4 bytes
    accessor["bufferView"] = document_["bufferViews"].size();
    document_["bufferViews"].push_back(std::move(view));
    index = document_["accessors"].size();
    document_["accessors"].push_back(std::move(accessor));
  }

  void keep_material(json& index, const std::string& texture_uri) {
    const json& from = chunks_.document;
    json material = from.at("materials").at(index.get<std::size_t>());
    json& surface = material["pbrMetallicRoughness"];
    if (surface.contains("baseColorTexture")) {
      json& texture_index = surface["baseColorTexture"].at("index");
      json texture = from.at("textures").at(texture_index.get<std::size_t>());
      const json& image = from.at("images").at(texture.at("source").get<std::size_t>());
      texture_ = bytes_of(view_at(image.at("bufferView")));
      texture_index = 0;
      texture["source"] = 0;
      document_["textures"] = json::array({std::move(texture)});
      document_["images"] = json::array({{{"uri", texture_uri}}});
      document_["samplers"] = from.at("samplers");
    }
    index = 0;
    document_["materials"] = json::array({std::move(material)});
  }

  const Chunks& chunks_;
  json document_;
  std::string buffer_;
  std::string texture_;
};

NodeGlb node_of(const Chunks& chunks, const std::string& name, const std::string& texture_uri) {
  for (const json& node : chunks.document.at("nodes")) {
    if (node.at("name") != name) continue;
    const auto mesh = node.at("mesh").get<std::size_t>();
    const std::size_t triangles = triangles_of(chunks, mesh);
    SeparateMesh separate(chunks, name, mesh, texture_uri);
    return {separate.bytes(), triangles, separate.take_texture()};
  }
  return {};
}

/// Reads a file and converts its chunks with `convert`; invalid content is an Error.
template <typename Result, typename Convert>
Expected<Result> read_chunks(const std::filesystem::path& file, Convert convert) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  try {
    return convert(chunks_of(*bytes));
  } catch (const InvalidGlb& invalid) {
    return Error{.message = invalid.what(), .file = file.string()};
  } catch (const json::exception&) {
    return Error{.message = "is not a scene's glTF: a property is missing or has another type",
                 .file = file.string()};
  }
}

}  // namespace

Expected<GlbContent> read_glb(const std::filesystem::path& file) {
  return read_chunks<GlbContent>(file, content_of);
}

Expected<NodeGlb> read_node_glb(const std::filesystem::path& file, const std::string& node,
                                const std::string& texture_uri) {
  return read_chunks<NodeGlb>(
      file, [&](const Chunks& chunks) { return node_of(chunks, node, texture_uri); });
}

}  // namespace pcavr
