// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/model/cad_model.hpp"

#include <cmath>
#include <sstream>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/input_ranges.hpp"

#include "base/model/cad_simplification.hpp"
#include "base/model/close_vertices.hpp"
#include "base/model/mesh_file.hpp"
#include "base/model/mesh_repair.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// A volume below this share of its bounding cube is rounding error of single precision.
constexpr double kMinVolumeShare = 1e-7;

Error no_volume_error(const fs::path& source, const std::string& reason) {
  return {.message = "CAD mesh has no volume: " + reason,
          .file = source.string(),
          .hint = "give a closed surface, wound outward (fill its holes in a CAD or mesh tool)"};
}

std::string describe(const model::OpenEdges& open) {
  std::ostringstream text;
  text << open.count << (open.count == 1 ? " edge is" : " edges are")
       << " open or between triangles of opposite winding, one near (" << open.location.x() << ", "
       << open.location.y() << ", " << open.location.z() << ")";
  return text.str();
}

void flip_winding(TriangleMesh& mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

/// Simplifies the mesh in place; nothing, and no change, if the result would not be a closed body
/// of the same volume.
std::optional<CadModel::Simplification> simplify(const CadOptions& options, double volume,
                                                 TriangleMesh& shape) {
  const auto max_triangles = static_cast<std::size_t>(options.max_triangles);
  if (shape.triangles.size() <= max_triangles) return std::nullopt;
  TriangleMesh simple = model::without_degenerate_triangles(
      model::simplified_cad(shape, max_triangles, options.max_error));
  // Very thin parts may have vanished.
  const bool is_valid =
      !simple.triangles.empty() && model::find_open_edges(simple).count == 0 &&
      std::abs(model::mass_properties(simple).volume - volume) < options.max_volume_change * volume;
  if (!is_valid || simple.triangles.size() >= shape.triangles.size()) return std::nullopt;
  const CadModel::Simplification result{shape.triangles.size(),
                                        model::hausdorff_distance(shape, simple)};
  shape = std::move(simple);
  return result;
}

/// `shape`: positions and triangles only, all coordinates finite.
Expected<CadModel> model_of_shape(TriangleMesh shape, const std::string& name,
                                  const fs::path& source, const CadOptions& options) {
  shape = model::weld_vertices(shape);
  // The open edges are searched before degenerate triangles are removed, which close the seams
  // between long edges and split ones.
  model::OpenEdges open = model::find_open_edges(shape);
  if (open.count > 0) {
    shape = model::with_closed_seams(shape);
    open = model::find_open_edges(shape);
  }
  if (open.count > 0) return no_volume_error(source, describe(open));
  model::MassProperties properties = model::mass_properties(shape);
  if (properties.volume < 0.0) {
    flip_winding(shape);
    properties.volume = -properties.volume;
  }
  const double size =
      shape.vertices.empty() ? 0.0 : static_cast<double>(bounds(shape.vertices).sizes().maxCoeff());
  if (std::optional<Error> error = check_range(ranges::kBodySize, size)) {
    error->message = "has a longest side of " + error->message;
    error->file = source.string();
    error->hint += "; give the mesh in metres";
    return *std::move(error);
  }
  if (!(properties.volume > kMinVolumeShare * size * size * size)) {
    return no_volume_error(source, "its surface encloses no volume");
  }

  CadModel cad;
  cad.name = name;
  cad.simplification = simplify(options, properties.volume, shape);
  cad.mesh_object =
      cad.simplification ? std::move(shape) : model::without_degenerate_triangles(std::move(shape));
  compute_vertex_normals(cad.mesh_object);
  cad.volume = properties.volume;
  cad.centre_of_mass_object = properties.centroid;
  return cad;
}

}  // namespace

Expected<CadModel> make_cad_model(const TriangleMesh& mesh_object, const std::string& name,
                                  const fs::path& source, const CadOptions& options) {
  for (const Eigen::Vector3f& vertex : mesh_object.vertices) {
    PCAVR_REQUIRE(vertex.allFinite(), vertex.x(), vertex.y(), vertex.z());
  }
  // Positions only: different normals or colours would prevent welding the corners of a box.
  TriangleMesh shape;
  shape.vertices = mesh_object.vertices;
  shape.triangles = mesh_object.triangles;
  return model_of_shape(std::move(shape), name, source, options);
}

Expected<CadModel> read_cad_model(const fs::path& file, const std::string& name,
                                  const CadOptions& options, double unit) {
  PCAVR_REQUIRE(unit > 0.0, unit);
  Expected<TriangleMesh> mesh = model::import_mesh(file, model::MeshContent::kShape);
  if (!mesh) return mesh.error();
  if (unit != 1.0) {
    for (Eigen::Vector3f& vertex : mesh->vertices) {
      vertex = (unit * vertex.cast<double>()).cast<float>();
    }
  }
  mesh->normals = {};
  mesh->colors = {};
  return model_of_shape(std::move(*mesh), name, file, options);
}

}  // namespace pcavr
