// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/export/plain_scene.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/scene/glb_file.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"

#include "export/exported_box.hpp"

namespace pcavr {
namespace {

TEST(PlainScene, IsReadBackWithItsTrianglesInBase) {
  const ExportedBox box;
  const auto scan = read_mesh(box.manifest().folder / "mesh.ply");
  ASSERT_TRUE(scan);
  const Eigen::Vector3d place = box.manifest().objects.front().T_base_object.translation();
  for (const PlainFormat format : {PlainFormat::ply, PlainFormat::obj, PlainFormat::stl}) {
    const auto written = write_plain_scene(box.manifest(), format, box.target());
    ASSERT_TRUE(written) << written.error().to_string();
    const auto mesh = read_mesh(box.target() / written->file);
    ASSERT_TRUE(mesh) << mesh.error().to_string();
    EXPECT_EQ(mesh->triangles.size(), scan->triangles.size() + 12U) << written->file;
    EXPECT_EQ(written->count, mesh->triangles.size());
    Eigen::AlignedBox3f bounds_base = bounds(mesh->vertices);
    EXPECT_TRUE(bounds_base.contains(place.cast<float>())) << written->file;
  }
}

TEST(PlainScene, HasTheScenesViewAndPoints) {
  const ExportedBox box;
  ASSERT_TRUE(write_plain_scene(box.manifest(), PlainFormat::gltf, box.target()));
  const auto content = read_glb(box.target() / "scene.glb");
  ASSERT_TRUE(content);
  EXPECT_TRUE(std::any_of(content->nodes.begin(), content->nodes.end(),
                          [](const GlbNode& node) { return node.name == "box"; }));
  const auto written = write_plain_scene(box.manifest(), PlainFormat::pcd, box.target());
  ASSERT_TRUE(written) << written.error().to_string();
  const auto cloud = read_cloud(box.target() / "scene.pcd");
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->points.size(), written->count);
  EXPECT_GT(written->count, 0U);
}

}  // namespace
}  // namespace pcavr
