// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/model/cad_model.hpp"

#include <cmath>
#include <sstream>
#include <utility>

#include "pcavr/core/check.hpp"
#include "pcavr/core/input_ranges.hpp"

#include "model/cad_simplification.hpp"
#include "model/mesh_repair.hpp"
#include "model/shape_file.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Below this share of its bounding cube, a volume is rounding of single-precision coordinates.
constexpr double kMinVolumeShare = 1e-7;
/// A simplified mesh whose volume is further off, as a share, has lost parts of the body.
constexpr double kMaxVolumeChange = 0.02;

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

/// The mesh that stands in for a finer one, if it is a body as the finer one is.
std::optional<CadModel::Simplification> simplify(const CadOptions& options, double volume,
                                                 TriangleMesh& shape) {
  if (shape.triangles.size() <= options.max_triangles) return std::nullopt;
  TriangleMesh simple =
      model::without_empty_triangles(model::simplified_cad(shape, options.max_triangles));
  // What is so thin that it vanished would not be the same body.
  const bool is_sound =
      !simple.triangles.empty() && model::find_open_edges(simple).count == 0 &&
      std::abs(model::mass_properties(simple).volume - volume) < kMaxVolumeChange * volume;
  if (!is_sound || simple.triangles.size() >= shape.triangles.size()) return std::nullopt;
  const CadModel::Simplification result{shape.triangles.size(),
                                        model::max_deviation(shape, simple)};
  shape = std::move(simple);
  return result;
}

/// `shape`: places and triangles only, all coordinates finite.
Expected<CadModel> model_of_shape(TriangleMesh shape, const std::string& name,
                                  const fs::path& source, const CadOptions& options) {
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
  if (std::optional<Error> error = check_range(ranges::kBodySize, size)) {
    error->message = "has a largest side of " + error->message;
    error->file = source.string();
    error->hint += "; give the mesh in metres";
    return *std::move(error);
  }
  if (!(properties.volume > kMinVolumeShare * size * size * size)) {
    return without_volume(source, "its surface encloses nothing");
  }

  CadModel cad;
  cad.name = name;
  cad.simplification = simplify(options, properties.volume, shape);
  cad.mesh_object =
      cad.simplification ? std::move(shape) : model::without_empty_triangles(std::move(shape));
  compute_vertex_normals(cad.mesh_object);
  cad.volume = properties.volume;
  cad.centre_of_mass_object = properties.centroid;
  return cad;
}

}  // namespace

Expected<CadModel> make_cad_model(const TriangleMesh& mesh_object, const std::string& name,
                                  const fs::path& source, const CadOptions& options) {
  for (const Eigen::Vector3f& vertex : mesh_object.vertices) {
    PCAVR_REQUIRE(vertex.allFinite(), vertex.transpose());
  }
  // Only places count here: normals and colours would keep corners of a box apart.
  TriangleMesh shape;
  shape.vertices = mesh_object.vertices;
  shape.triangles = mesh_object.triangles;
  return model_of_shape(std::move(shape), name, source, options);
}

Expected<CadModel> read_cad_model(const fs::path& file, const std::string& name,
                                  const CadOptions& options) {
  Expected<TriangleMesh> mesh = model::import_shape(file);
  if (!mesh) return mesh.error();
  mesh->normals = {};
  mesh->colors = {};
  return model_of_shape(std::move(*mesh), name, file, options);
}

}  // namespace pcavr
