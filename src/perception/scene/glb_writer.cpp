// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/scene/glb_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/raw_bytes.hpp"

#include "glb_format.hpp"

namespace pcavr {
namespace {

using nlohmann::json;

/// Lookup table from 8-bit sRGB to 16-bit linear intensity [IEC 61966-2-1].
std::array<std::uint16_t, 256> make_linear_of_srgb() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double s = static_cast<double>(i) / 255.0;
    const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    table[i] = static_cast<std::uint16_t>(std::lround(linear * 65535.0));
  }
  return table;
}

std::uint16_t linear_of_srgb(std::uint8_t channel) {
  static const std::array<std::uint16_t, 256> kTable = make_linear_of_srgb();
  return kTable[channel];
}

json list_of(const Eigen::Vector3f& v) { return json::array({v.x(), v.y(), v.z()}); }

void pad(std::string& bytes, char padding) {
  while (bytes.size() % 4 != 0) bytes += padding;
}

std::vector<Eigen::Vector3f> unit_normals(const TriangleMesh& mesh) {
  if (mesh.normals.empty()) {
    TriangleMesh copy = mesh;
    compute_vertex_normals(copy);
    return copy.normals;
  }
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(mesh.normals.size());
  for (const Eigen::Vector3f& normal : mesh.normals) {
    const double norm = normal.cast<double>().norm();
    // glTF requires unit normals.
    normals.push_back(norm > 1e-12 ? (normal.cast<double>() / norm).cast<float>().eval()
                                   : Eigen::Vector3f::UnitZ().eval());
  }
  return normals;
}

json matt() { return {{"metallicFactor", 0.0}, {"roughnessFactor", 0.9}}; }

/// An unlit, two-sided material: its colours contain the lighting.
json captured(json& document, const char* name) {
  document["extensionsUsed"] = json::array({"KHR_materials_unlit"});
  json material = {{"name", name}, {"doubleSided", true}};
  material["extensions"]["KHR_materials_unlit"] = json::object();
  material["pbrMetallicRoughness"] = matt();
  return material;
}

}  // namespace

int GlbWriter::add_view(std::size_t first_byte, int target) {
  document_["bufferViews"].push_back({{"buffer", 0},
                                      {"byteOffset", first_byte},
                                      {"byteLength", buffer_.size() - first_byte},
                                      {"target", target}});
  return static_cast<int>(document_["bufferViews"].size()) - 1;
}

int GlbWriter::add_accessor(int view, int component_type, const char* type, std::size_t count) {
  document_["accessors"].push_back(
      {{"bufferView", view}, {"componentType", component_type}, {"type", type}, {"count", count}});
  return static_cast<int>(document_["accessors"].size()) - 1;
}

int GlbWriter::add_vectors(const std::vector<Eigen::Vector3f>& vectors, bool with_bounds) {
  const std::size_t first_byte = buffer_.size();
  for (const Eigen::Vector3f& vector : vectors) {
    for (const float number : vector) append_bytes(buffer_, number);
  }
  const int accessor =
      add_accessor(add_view(first_byte, kGlbArrayBuffer), kGlbFloat, "VEC3", vectors.size());
  if (with_bounds) {
    const Eigen::AlignedBox3f box = bounds(vectors);
    document_["accessors"].back()["min"] = list_of(box.min());
    document_["accessors"].back()["max"] = list_of(box.max());
  }
  return accessor;
}

int GlbWriter::add_colors(const std::vector<Rgb8>& colors) {
  const std::size_t first_byte = buffer_.size();
  for (const Rgb8& color : colors) {
    for (const std::uint8_t channel : {color.r, color.g, color.b}) {
      append_bytes(buffer_, linear_of_srgb(channel));
    }
    append_bytes(buffer_, std::uint16_t{65535});  // opaque; keeps the elements 4-byte aligned
  }
  const int accessor =
      add_accessor(add_view(first_byte, kGlbArrayBuffer), kGlbUnsignedShort, "VEC4", colors.size());
  document_["accessors"].back()["normalized"] = true;
  return accessor;
}

int GlbWriter::add_texture_coordinates(const std::vector<Eigen::Vector2f>& coordinates) {
  const std::size_t first_byte = buffer_.size();
  for (const Eigen::Vector2f& at : coordinates) {
    for (const float number : at) append_bytes(buffer_, number);
  }
  return add_accessor(add_view(first_byte, kGlbArrayBuffer), kGlbFloat, "VEC2", coordinates.size());
}

int GlbWriter::add_indices(const TriangleMesh& mesh) {
  const std::size_t first_byte = buffer_.size();
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) append_bytes(buffer_, vertex);
  }
  return add_accessor(add_view(first_byte, kGlbElementArrayBuffer), kGlbUnsignedInt, "SCALAR",
                      mesh.triangles.size() * 3);
}

int GlbWriter::material_index(const json& material) {
  auto& materials = document_["materials"];
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (materials[i] == material) return static_cast<int>(i);
  }
  materials.push_back(material);
  return static_cast<int>(materials.size()) - 1;
}

int GlbWriter::surface_material(GlbMaterial kind, bool has_colors, const Rgb8& color) {
  if (kind == GlbMaterial::captured) return material_index(captured(document_, "captured"));
  json material = {{"name", has_colors ? "body" : "plain_body"}};
  auto& surface = material["pbrMetallicRoughness"] = matt();
  if (!has_colors) {
    json& factor = surface["baseColorFactor"];
    for (const std::uint8_t channel : {color.r, color.g, color.b}) {
      factor.push_back(linear_of_srgb(channel) / 65535.0);
    }
    factor.push_back(1.0);
  }
  return material_index(material);
}

int GlbWriter::textured_material(std::size_t texture) {
  json material = captured(document_, "captured_texture");
  material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = texture;
  return material_index(material);
}

int GlbWriter::add_mesh(const std::string& name, const TriangleMesh& mesh, GlbMaterial material,
                        const Rgb8& color) {
  PCAVR_REQUIRE(!mesh.triangles.empty(), name);
  json primitive = begin_primitive(mesh);
  if (!mesh.colors.empty()) primitive["attributes"]["COLOR_0"] = add_colors(mesh.colors);
  primitive["indices"] = add_indices(mesh);
  primitive["material"] = surface_material(material, !mesh.colors.empty(), color);
  return add_primitive(name, primitive);
}

int GlbWriter::add_textured_mesh(const std::string& name, const TriangleMesh& mesh,
                                 const std::vector<Eigen::Vector2f>& coordinates,
                                 const std::string& jpeg) {
  PCAVR_REQUIRE(!mesh.triangles.empty() && coordinates.size() == mesh.vertices.size(), name);
  const auto known = std::find(textures_.begin(), textures_.end(), jpeg);
  const auto texture = static_cast<std::size_t>(known - textures_.begin());
  if (known == textures_.end()) textures_.push_back(jpeg);
  json primitive = begin_primitive(mesh);
  primitive["attributes"]["TEXCOORD_0"] = add_texture_coordinates(coordinates);
  primitive["indices"] = add_indices(mesh);
  primitive["material"] = textured_material(texture);
  return add_primitive(name, primitive);
}

json GlbWriter::begin_primitive(const TriangleMesh& mesh) {
  json primitive;
  primitive["attributes"]["POSITION"] = add_vectors(mesh.vertices, true);
  primitive["attributes"]["NORMAL"] = add_vectors(unit_normals(mesh), false);
  return primitive;
}

int GlbWriter::add_primitive(const std::string& name, const json& primitive) {
  document_["meshes"].push_back({{"name", name}, {"primitives", json::array({primitive})}});
  return static_cast<int>(document_["meshes"].size()) - 1;
}

int GlbWriter::add_node(const std::string& name, const Pose& T_parent_node, int mesh) {
  const Eigen::Vector3d& t = T_parent_node.translation();
  const Eigen::Quaterniond& q = T_parent_node.rotation();
  json node = {{"name", name},
               {"translation", json::array({t.x(), t.y(), t.z()})},
               {"rotation", json::array({q.x(), q.y(), q.z(), q.w()})}};
  if (mesh >= 0) node["mesh"] = mesh;
  document_["nodes"].push_back(node);
  return static_cast<int>(document_["nodes"].size()) - 1;
}

/// Last in the buffer, so that a reader can separate them (glb_reader.cpp).
void GlbWriter::add_textures() {
  constexpr int kLinear = 9729;
  constexpr int kLinearMipmapLinear = 9987;
  constexpr int kClampToEdge = 33071;
  document_["samplers"] = json::array({{{"magFilter", kLinear},
                                        {"minFilter", kLinearMipmapLinear},
                                        {"wrapS", kClampToEdge},
                                        {"wrapT", kClampToEdge}}});
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    document_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", textures_[i].size()}});
    buffer_ += textures_[i];
    pad(buffer_, '\0');
    document_["images"].push_back(
        {{"mimeType", "image/jpeg"}, {"bufferView", document_["bufferViews"].size() - 1}});
    document_["textures"].push_back({{"sampler", 0}, {"source", i}});
  }
}

std::string GlbWriter::finish(int root, const std::vector<int>& children) {
  document_["asset"] = {{"version", "2.0"}, {"generator", "pcavr " PCAVR_VERSION}};
  document_["scene"] = 0;
  document_["scenes"] = json::array({{{"nodes", json::array({root})}}});
  if (!children.empty()) document_["nodes"][static_cast<std::size_t>(root)]["children"] = children;
  if (!textures_.empty()) add_textures();
  pad(buffer_, '\0');
  if (!buffer_.empty()) {
    document_["buffers"] = json::array({{{"byteLength", buffer_.size()}}});
  }
  return assemble_glb(document_, buffer_);
}

std::string assemble_glb(const json& document, std::string_view buffer) {
  // Replaces invalid UTF-8 in names instead of throwing.
  std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  pad(text, ' ');
  std::string file;
  const std::size_t binary_size = buffer.empty() ? 0 : 8 + buffer.size();
  file.reserve(20 + text.size() + binary_size);
  append_bytes(file, kGlbMagic);
  append_bytes(file, std::uint32_t{2});
  append_bytes(file, static_cast<std::uint32_t>(20 + text.size() + binary_size));
  append_bytes(file, static_cast<std::uint32_t>(text.size()));
  append_bytes(file, kGlbJsonChunk);
  file += text;
  if (buffer.empty()) return file;
  append_bytes(file, static_cast<std::uint32_t>(buffer.size()));
  append_bytes(file, kGlbBinaryChunk);
  return file += buffer;
}

Pose glb_root_pose() {
  return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI_2, Eigen::Vector3d::UnitX())),
              Eigen::Vector3d::Zero());
}

}  // namespace pcavr
