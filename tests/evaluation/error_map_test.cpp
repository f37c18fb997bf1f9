// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/evaluation/error_map.hpp"

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// A metre of a plane, in two triangles.
TriangleMesh plane() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(ErrorMap, ColoursEachVertexByItsDistance) {
  TriangleMesh mesh = plane();
  mesh.vertices[1].z() = 0.005F;
  mesh.vertices[2].z() = 0.5F;
  const ErrorMap map = error_map(plane(), mesh, {}, 0.008, {1});
  EXPECT_EQ(map.mesh_base.colors[0], (Rgb8{68, 1, 84}));
  EXPECT_EQ(map.mesh_base.colors[1], (Rgb8{33, 145, 140}));
  EXPECT_EQ(map.mesh_base.colors[2], (Rgb8{253, 231, 37}));
  EXPECT_EQ(map.max_error, 0.010);
  EXPECT_EQ(map.mesh_base.normals.size(), mesh.vertices.size());
}

TEST(ErrorMap, ShowsTheMeshInItsColoursFromWhereTheCamerasWere) {
  const std::vector<Pose> cameras{Pose::from_translation({0.5, -1.0, 0.3})};
  const ErrorMap map = error_map(plane(), plane(), cameras, 0.0, {1});
  const ColorImage picture = *ImageDecoder().color(map.jpeg, {"picture", 960, 600});
  int violet = 0;
  for (const Rgb8& pixel : picture.pixels()) {
    violet += pixel.r > pixel.g + 30 && pixel.b > pixel.g + 30 ? 1 : 0;
  }
  EXPECT_GT(violet, 960 * 600 / 10);
  EXPECT_EQ(error_map(plane(), plane(), cameras, 0.0, {2}).jpeg, map.jpeg);
}

TEST(ErrorMap, OfAnEmptyMeshHasNoPicture) {
  EXPECT_TRUE(error_map(plane(), {}, {}, 0.0, {1}).jpeg.empty());
}

}  // namespace
}  // namespace pcavr
