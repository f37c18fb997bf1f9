// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/model/cad_model.hpp"

#include <cmath>
#include <sstream>

#include "pcavr/core/check.hpp"

#include "model/mesh_file.hpp"
#include "model/mesh_repair.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Below this share of its bounding cube, a volume is rounding of single-precision coordinates.
constexpr double kSmallestVolumeShare = 1e-7;

Error without_volume(const fs::path& source, const std::string& reason) {
  return {.message = "CAD mesh has no volume: " + reason,
          .file = source.string(),
          .hint = "give a closed surface, wound outward (fill its holes in a CAD or mesh tool)"};
}

std::string describe(const model::OpenEdges& open) {
  std::ostringstream text;
  text << open.count << (open.count == 1 ? " edge is" : " edges are")
       << " open or between triangles wound against each other, one near (" << open.somewhere.x()
       << ", " << open.somewhere.y() << ", " << open.somewhere.z() << ")";
  return text.str();
}

void turn(TriangleMesh& mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

}  // namespace

Expected<CadModel> make_cad_model(const TriangleMesh& mesh_object, const std::string& name,
                                  const fs::path& source) {
  for (const Eigen::Vector3f& vertex : mesh_object.vertices) {
    PCAVR_REQUIRE(vertex.allFinite(), vertex.transpose());
  }
  // Only places count here: normals and colours would keep corners of a box apart.
  TriangleMesh shape;
  shape.vertices = mesh_object.vertices;
  shape.triangles = mesh_object.triangles;
  shape = model::join_equal_vertices(shape);

  // Before slivers are dropped: they close the seams between long edges and split ones.
  const model::OpenEdges open = model::find_open_edges(shape);
  if (open.count > 0) return without_volume(source, describe(open));
  model::MassProperties properties = model::mass_properties(shape);
  if (properties.volume < 0.0) {
    turn(shape);
    properties.volume = -properties.volume;
  }
  const double size =
      shape.vertices.empty() ? 0.0 : static_cast<double>(bounds(shape.vertices).sizes().maxCoeff());
  if (!(properties.volume > kSmallestVolumeShare * size * size * size)) {
    return without_volume(source, "its surface encloses nothing");
  }

  CadModel cad;
  cad.name = name;
  cad.mesh_object = model::without_empty_triangles(std::move(shape));
  compute_vertex_normals(cad.mesh_object);
  cad.volume = properties.volume;
  cad.centre_of_mass_object = properties.centroid;
  return cad;
}

Expected<CadModel> read_cad_model(const fs::path& file, const std::string& name) {
  const Expected<TriangleMesh> mesh = model::import_mesh(file);
  if (!mesh) return mesh.error();
  return make_cad_model(*mesh, name, file);
}

}  // namespace pcavr
