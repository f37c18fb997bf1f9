// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "pcavr/base/core/check.hpp"
#include "pcavr/perception/scene/glb_file.hpp"
#include "pcavr/perception/scene/ply_file.hpp"
#include "pcavr/perception/scene/scene_text.hpp"

#include "fuzz/memory_file.hpp"
#include "fuzz/targets.hpp"

namespace pcavr::fuzz {
namespace {

constexpr char kSceneFile[] = "the-file";

void require_place(const Error& error, const std::string& file) {
  PCAVR_REQUIRE(error.file == file && !error.message.empty(), error.to_string());
}

void read_manifest(const std::string& text) {
  const Expected<SceneManifest> manifest = parse_scene_manifest(text, kSceneFile);
  if (!manifest) return require_place(manifest.error(), kSceneFile);
  const std::string written = format_scene_manifest(*manifest);
  const Expected<SceneManifest> reparsed = parse_scene_manifest(written, kSceneFile);
  PCAVR_REQUIRE(reparsed.has_value(), reparsed.error().to_string(), written);
  PCAVR_REQUIRE(reparsed->objects.size() == manifest->objects.size());
  PCAVR_REQUIRE(reparsed->support_planes.size() == manifest->support_planes.size());
}

void read_display(std::string_view bytes) {
  const MemoryFile file(bytes);
  const Expected<GlbContent> content = read_glb(file.path());
  if (!content) return require_place(content.error(), file.path());
  for (const GlbNode& node : content->nodes) {
    const Expected<NodeGlb> part = read_node_glb(file.path(), node.name, "texture.jpg");
    if (!part) require_place(part.error(), file.path());
  }
}

void read_surface(std::string_view bytes) {
  const MemoryFile file(bytes);
  const Expected<TriangleMesh> mesh = read_ply(file.path());
  if (!mesh) return require_place(mesh.error(), file.path());
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t vertex : triangle) PCAVR_REQUIRE(vertex < mesh->vertices.size());
  }
}

}  // namespace

void scene(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view content = bytes.substr(1);
  switch (bytes.front()) {
    case 'y':
      return read_manifest(std::string(content));
    case 'g':
      return read_display(content);
    default:
      return read_surface(content);
  }
}

}  // namespace pcavr::fuzz
