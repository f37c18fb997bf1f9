// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/cad_simplification.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/base/model/cad_model.hpp"

#include "base/model/mesh_repair.hpp"
#include "base/model/vertex_clustering.hpp"
#include "support/meshes.hpp"

namespace pcavr::model {
namespace {

using test::box_mesh;
using test::sphere_mesh;

/// Each triangle subdivided into four at the midpoints of its edges, `times` times.
TriangleMesh subdivided(TriangleMesh mesh, int times) {
  for (; times > 0; --times) {
    TriangleMesh finer;
    for (const auto& t : mesh.triangles) {
      const auto first = static_cast<std::uint32_t>(finer.vertices.size());
      for (std::size_t k = 0; k < 3; ++k) finer.vertices.push_back(mesh.vertices[t[k]]);
      for (std::size_t k = 0; k < 3; ++k) {
        // Bitwise equal from either triangle: the sum of two does not depend on their order.
        finer.vertices.emplace_back(0.5F * (mesh.vertices[t[k]] + mesh.vertices[t[(k + 1) % 3]]));
      }
      for (const auto& [a, b, c] : {std::array{0U, 3U, 5U}, std::array{3U, 1U, 4U},
                                    std::array{5U, 4U, 2U}, std::array{3U, 4U, 5U}}) {
        finer.triangles.push_back({first + a, first + b, first + c});
      }
    }
    mesh = weld_vertices(finer);
  }
  return mesh;
}

TEST(CadModel, WithFewTrianglesIsNotSimplified) {
  const CadModel sphere = *make_cad_model(sphere_mesh(0.1F, 70), "ball", "ball.stl");
  EXPECT_FALSE(sphere.simplification);
  EXPECT_EQ(sphere.mesh_object.triangles.size(), sphere_mesh(0.1F, 70).triangles.size());
}

TEST(CadModel, OfAFineSphereIsSimplifiedWithItsErrorStatedAndTheFullMass) {
  const TriangleMesh full = sphere_mesh(0.1F, 150);
  const CadModel sphere = *make_cad_model(full, "ball", "ball.stl");
  ASSERT_TRUE(sphere.simplification);
  EXPECT_EQ(sphere.simplification->full_triangles, full.triangles.size());
  EXPECT_LE(sphere.mesh_object.triangles.size(), 20'000U);
  EXPECT_EQ(find_open_edges(sphere.mesh_object).count, 0U);
  // 20 000 triangles on this sphere have edges of 3.8 mm, whose sag is 0.02 mm.
  EXPECT_LT(sphere.simplification->max_error, 1e-4);
  // No point may be further away than the stated error, with a tolerance for single precision.
  const SurfaceQuery surface(sphere.mesh_object);
  for (const Eigen::Vector3f& p : full.vertices) {
    const auto nearest = surface.closest(p, 0.01F);
    ASSERT_TRUE(nearest);
    EXPECT_LE(nearest->distance, sphere.simplification->max_error + 1e-7);
  }
  const MassProperties exact = mass_properties(full);
  EXPECT_DOUBLE_EQ(sphere.volume, exact.volume);
  EXPECT_LT((sphere.centre_of_mass_object - exact.centroid).norm(), 1e-9);
}

TEST(CadModel, OfAFinelyTessellatedBoxKeepsItsEdgesAndCorners) {
  const TriangleMesh full = subdivided(box_mesh({0.2F, 0.15F, 0.1F}), 6);
  ASSERT_GT(full.triangles.size(), 40'000U);
  CadOptions options;
  options.max_triangles = 2000;
  const CadModel box = *make_cad_model(full, "box", "box.stl", options);
  ASSERT_TRUE(box.simplification);
  EXPECT_LE(box.mesh_object.triangles.size(), 2000U);
  EXPECT_LT(box.simplification->max_error, 2e-6);
  EXPECT_NEAR(signed_volume(box.mesh_object), 0.2 * 0.15 * 0.1, 1e-8);
}

TEST(ClusterVertices, KeepsAClosedMeshClosedAndAccurate) {
  const TriangleMesh full = sphere_mesh(0.1F, 150);
  const TriangleMesh clustered = cluster_vertices(full, 0.005);
  EXPECT_LT(clustered.triangles.size(), full.triangles.size() / 4);
  EXPECT_EQ(find_open_edges(clustered).count, 0U);
  // A chord of a cell's diagonal, 8.7 mm, sags by 0.1 mm.
  EXPECT_LT(hausdorff_distance(full, clustered), 2e-4);
  EXPECT_NEAR(signed_volume(clustered), signed_volume(full), 0.005 * signed_volume(full));
}

TEST(ClusterVertices, KeepsTheSidesOfAWallThinnerThanACellApart) {
  const TriangleMesh wall = subdivided(box_mesh({0.2F, 0.2F, 0.001F}), 5);
  const TriangleMesh clustered = cluster_vertices(wall, 0.008);
  EXPECT_EQ(find_open_edges(clustered).count, 0U);
  EXPECT_NEAR(signed_volume(clustered), signed_volume(wall), 0.02 * signed_volume(wall));
}

TEST(HausdorffDistance, IsZeroToTheSameMeshAndTheGapToAnother) {
  const TriangleMesh box = box_mesh({0.2F, 0.15F, 0.1F});
  EXPECT_LT(hausdorff_distance(box, box), 2e-7);
  const TriangleMesh smaller = box_mesh({0.2F, 0.15F, 0.098F});
  EXPECT_NEAR(hausdorff_distance(box, smaller), 0.001, 1e-6);
}

TEST(HausdorffDistance, SamplesTheInteriorOfLargeTriangles) {
  // A face that is dented in the middle: all vertices of the flat one lie on the other's edges.
  const TriangleMesh flat = box_mesh({0.2F, 0.2F, 0.1F});
  TriangleMesh dented = flat;
  const auto middle = static_cast<std::uint32_t>(dented.vertices.size());
  dented.vertices.emplace_back(0.0F, 0.0F, 0.03F);
  dented.triangles.erase(dented.triangles.begin() + 2, dented.triangles.begin() + 4);
  for (const auto& [a, b] :
       {std::pair(4U, 5U), std::pair(5U, 7U), std::pair(7U, 6U), std::pair(6U, 4U)}) {
    dented.triangles.push_back({a, b, middle});
  }
  ASSERT_EQ(find_open_edges(dented).count, 0U);
  EXPECT_NEAR(hausdorff_distance(flat, dented), 0.0196,
              0.0006);  // 0.02 along z, on a slope of 1 in 5
}

}  // namespace
}  // namespace pcavr::model
