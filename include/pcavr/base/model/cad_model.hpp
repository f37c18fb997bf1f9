// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// A rigid body's CAD surface, in its own (object) frame.
struct CadModel {
  std::string name;
  TriangleMesh mesh_object;  ///< closed, outward winding, vertices shared, normals per vertex
  double volume = 0.0;       ///< [m^3], > 0
  Eigen::Vector3d centre_of_mass_object = Eigen::Vector3d::Zero();  ///< at uniform density [m]
  /// Set if the mesh is a decimated version of a finer one; volume and centre of mass are those of
  /// the full mesh.
  struct Simplification {
    std::size_t full_triangles = 0;
    double max_error = 0.0;  ///< [m] measured one-sided Hausdorff distance, full mesh to this mesh
  };
  std::optional<Simplification> simplification = {};
};

/// See src/base/model/options.cpp for meanings, ranges and defaults.
struct CadOptions {
  CadOptions();

  int max_triangles;
  double max_error;  ///< [m]
  double max_volume_change;
};

/// The options "model.cad".
[[nodiscard]] OptionSection section_of(CadOptions& options);

/// Reads `.obj .stl .ply .dae .glb .gltf`: as stored (.dae: its unit applied), no axis swap.
/// Coincident vertices are welded, those of open edges also where they differ by rounding, and a
/// mesh whose winding is inward is flipped; an inner shell of opposite winding is a cavity. Errors:
/// no such file, unknown type, not a mesh, a required extension of glTF that is not read, a
/// coordinate that is not finite, open edges (not watertight), no volume. A `.dae` is read in a
/// child process, of which a crash is an Error. `unit` [m]: that of the stored coordinates.
/// Thread-safe.
[[nodiscard]] Expected<CadModel> read_cad_model(const std::filesystem::path& file,
                                                const std::string& name,
                                                const CadOptions& options = {}, double unit = 1.0);

/// A CAD model from triangles in memory, validated as by read_cad_model; `source` identifies them
/// in errors.
[[nodiscard]] Expected<CadModel> make_cad_model(const TriangleMesh& mesh_object,
                                                const std::string& name,
                                                const std::filesystem::path& source,
                                                const CadOptions& options = {});

/// Reads any triangle mesh, open ones too. Polygons are triangulated; degenerate triangles, lines
/// and points are discarded; vertices with equal attributes are welded. Vertex colours and normals
/// are kept if every part of the file has them (the face normals of an STL are not). Same errors as
/// read_cad_model, except that the mesh may be open. Thread-safe.
[[nodiscard]] Expected<TriangleMesh> read_mesh(const std::filesystem::path& file);

/// Closest-point and ray-casting queries on triangles, in the frame of the mesh. The bounding
/// volume hierarchy (BVH) is built once (on all cores if the mesh is large), then const and
/// thread-safe. Traversal by Embree in its robust mode; closest points are computed in double
/// precision.
class SurfaceQuery {
 public:
  /// Copies the mesh data; queries on an empty mesh return nothing. Throws ContractError unless all
  /// vertices are finite and all indices valid.
  explicit SurfaceQuery(const TriangleMesh& mesh);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  struct Closest {
    Eigen::Vector3f point;
    Eigen::Vector3f normal;  ///< of that triangle, unit, outward by winding; zero if it has no area
    float distance = 0.0F;   ///< [m], >= 0
    std::uint32_t triangle = 0;  ///< the lowest index among equally near ones
  };
  /// Returns nothing if no surface lies within `radius` [m], >= 0, or the point is not finite.
  [[nodiscard]] std::optional<Closest> closest(const Eigen::Vector3f& point, float radius) const;

  struct Hit {
    float distance = 0.0F;   ///< along the unit direction [m]
    Eigen::Vector3f normal;  ///< of that triangle, unit, by winding
    std::uint32_t triangle = 0;
    float u = 0.0F;  ///< barycentric weight of the second corner
    float v = 0.0F;  ///< barycentric weight of the third corner
  };
  /// Ray casting: the first surface along a ray; `direction` need not be of unit length. Returns
  /// nothing for a direction that is zero or not finite.
  [[nodiscard]] std::optional<Hit> cast(const Eigen::Vector3f& origin,
                                        const Eigen::Vector3f& direction) const;

  /// Bounding box of all vertices; empty for an empty mesh.
  [[nodiscard]] const Eigen::AlignedBox3f& bounds() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Renders the depth image of an ideal (noise-free) camera; 0 where no surface is hit.
/// `T_mesh_camera` is the camera's pose in the mesh frame. Bitwise identical for any Parallelism.
[[nodiscard]] DepthImage render_depth(const SurfaceQuery& surface, const CameraModel& camera,
                                      const Pose& T_mesh_camera, Parallelism parallelism = {});

/// Bounding rectangle of the projection of a body with these bounds; `x_end` and `y_end` are
/// exclusive. The whole image if part of the box lies behind the camera.
struct PixelRectangle {
  int x_begin = 0;
  int y_begin = 0;
  int x_end = 0;
  int y_end = 0;
  [[nodiscard]] bool empty() const { return x_begin >= x_end || y_begin >= y_end; }
};
[[nodiscard]] PixelRectangle visible_rectangle(const Eigen::AlignedBox3f& bounds_mesh,
                                               const CameraModel& camera,
                                               const Pose& T_mesh_camera);

}  // namespace pcavr
