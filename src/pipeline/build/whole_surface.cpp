// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "pcavr/base/model/mesh_simplification.hpp"
#include "pcavr/perception/reconstruction/mesh_cleanup.hpp"

#include "surface_builder.hpp"
#include "surface_fusion.hpp"

namespace pcavr {
namespace {

class WholeSurface final : public SurfaceBuilder {
 public:
  explicit WholeSurface(const BuildOptions& options) : options_(options), fusion_(options) {}

  [[nodiscard]] bool needs_fused() const override { return true; }

  void add(const FollowedFrame& frame, const FusedFrame& fused) override {
    fusion_.add(fused, frame.is_dynamic, frame.T_base_camera);
  }

  Expected<TriangleMesh> mesh(const SurfaceEvidence& evidence, const Observer&) override {
    // Freed afterwards: the blocks take more than the mesh.
    const TsdfPart volume = std::move(fusion_.volume);
    TriangleMesh mesh =
        volume.extract_tile({options_.min_weight, options_.min_weight}, options_.parallelism).mesh;
    remove_small_components(mesh, options_.min_island);
    if (mesh.triangles.empty() || evidence.min_uncontradicted_weight >= options_.min_weight)
      return mesh;
    mesh = volume.extract_tile(evidence, options_.parallelism).mesh;
    remove_small_components(mesh, options_.min_island);
    return mesh;
  }

  PointCloud cloud(const TriangleMesh& mesh_base, const SurfaceEvidence& evidence) override {
    return fusion_.points_on(mesh_base, evidence);
  }

  [[nodiscard]] std::vector<TriangleMesh> levels_of_detail(
      const TriangleMesh& mesh_base) const override {
    const double max_error = options_.level_of_detail_error * options_.fusion.voxel_size;
    std::vector<TriangleMesh> levels{simplified(mesh_base, kLevelOfDetailTriangles[0], max_error)};
    add_coarser_levels(options_, levels);
    return levels;
  }

 private:
  const BuildOptions& options_;
  SurfaceFusion fusion_;
};

}  // namespace

std::unique_ptr<SurfaceBuilder> make_whole_surface(const BuildOptions& options) {
  return std::make_unique<WholeSurface>(options);
}

}  // namespace pcavr
