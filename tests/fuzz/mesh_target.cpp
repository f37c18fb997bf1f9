// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "pcavr/base/core/check.hpp"

#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_readers.hpp"
#include "fuzz/memory_file.hpp"
#include "fuzz/targets.hpp"

namespace pcavr::fuzz {
namespace {

TriangleMesh read_as(char type, const std::string& path) {
  switch (type) {
    case 's':
      return model::read_stl_mesh(path);
    case 'p':
      return model::read_ply_mesh(path);
    case 'o':
      return model::read_obj_mesh(path, model::MeshContent::kAll);
    default:
      return model::read_gltf_mesh(path);
  }
}

}  // namespace

void mesh(std::string_view bytes) {
  if (bytes.empty()) return;
  const MemoryFile file(bytes.substr(1));
  TriangleMesh read;
  try {
    read = read_as(bytes.front(), file.path());
  } catch (const model::MeshFault& fault) {
    PCAVR_REQUIRE(fault.what()[0] != '\0');
    return;
  }
  const std::size_t count = read.vertices.size();
  for (const auto& triangle : read.triangles) {
    for (const std::uint32_t vertex : triangle) PCAVR_REQUIRE(vertex < count, vertex, count);
  }
  PCAVR_REQUIRE(read.normals.empty() || read.normals.size() == count);
  PCAVR_REQUIRE(read.colors.empty() || read.colors.size() == count);
}

}  // namespace pcavr::fuzz
