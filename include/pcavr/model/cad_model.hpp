// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

/// A rigid body's CAD surface, in its own (object) frame.
struct CadModel {
  std::string name;
  TriangleMesh mesh_object;             ///< outward winding, vertices shared, normals per vertex
  double volume = 0.0;                  ///< [m^3], > 0
  Eigen::Vector3d centre_of_mass_object;  ///< at uniform density [m]
};

/// Reads `.obj .stl .ply .glb .gltf`: coordinates as stored, node transforms applied, no axis swap.
/// A mesh with inward winding is turned; one without a volume is an Error.
[[nodiscard]] Expected<CadModel> read_cad_model(const std::filesystem::path& file,
                                                const std::string& name);

/// Reads any triangle mesh, open ones too (vertex colours and normals kept where present).
[[nodiscard]] Expected<TriangleMesh> read_mesh(const std::filesystem::path& file);

/// Closest points and rays against triangles, in the frame of the meshes given. Built once, then
/// const and thread-safe. Exact (Embree with robust traversal).
class SurfaceQuery {
 public:
  explicit SurfaceQuery(const TriangleMesh& mesh);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  struct Closest {
    Eigen::Vector3f point;
    Eigen::Vector3f normal;  ///< of the triangle hit, unit, outward by winding
    float distance = 0.0F;   ///< [m], >= 0
    std::uint32_t triangle = 0;
  };
  /// Nothing if no surface lies within `radius` [m].
  [[nodiscard]] std::optional<Closest> closest(const Eigen::Vector3f& point, float radius) const;

  struct Hit {
    float distance = 0.0F;   ///< along the unit direction [m]
    Eigen::Vector3f normal;  ///< of the triangle hit, unit, by winding
    std::uint32_t triangle = 0;
    float u = 0.0F;  ///< barycentric weight of the second corner
    float v = 0.0F;  ///< barycentric weight of the third corner
  };
  /// The first surface along a ray; `direction` need not be of unit length.
  [[nodiscard]] std::optional<Hit> cast(const Eigen::Vector3f& origin,
                                        const Eigen::Vector3f& direction) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Depth of the surface as an ideal camera would see it; 0 where it is not hit. `T_mesh_camera` is
/// the camera's pose in the frame of the query's mesh.
[[nodiscard]] DepthImage render_depth(const SurfaceQuery& surface, const CameraModel& camera,
                                      const Pose& T_mesh_camera);

}  // namespace pcavr
