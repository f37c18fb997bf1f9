// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/glb_file.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/raw_bytes.hpp"
#include "pcavr/base/geometry/sharp_edges.hpp"

#include "perception/scene/glb_writer.hpp"
#include "scene/scene_builder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using nlohmann::json;

/// One triangle with one colour per corner.
TriangleMesh a_triangle() {
  return {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, -3}},
          .normals = {{0, 0, 2}, {0, 0, 0}, {0.6F, 0, 0.8F}},
          .colors = {{0, 0, 0}, {255, 255, 255}, {188, 10, 127}},
          .triangles = {{0, 1, 2}}};
}

struct Glb {
  explicit Glb(const std::string& bytes)
      : document(json::parse(bytes.substr(20, load_value<std::uint32_t>(bytes.data(), 12)))),
        buffer(bytes.substr(20 + load_value<std::uint32_t>(bytes.data(), 12) + 8)) {}

  template <typename Value>
  [[nodiscard]] Value at(const std::string& attribute, std::size_t index) const {
    const json& primitive = document["meshes"][0]["primitives"][0];
    const json& accessor =
        document["accessors"][primitive["attributes"][attribute].get<std::size_t>()];
    const json& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    return load_value<Value>(buffer.data(),
                             view["byteOffset"].get<std::size_t>() + index * sizeof(Value));
  }

  json document;
  std::string buffer;
};

std::string a_file(const TriangleMesh& mesh) {
  GlbWriter writer;
  const int number = writer.add_mesh("part", mesh, GlbMaterial::body);
  const int node = writer.add_node("part", Pose::from_translation({1, 2, 3}), number);
  return writer.finish(writer.add_node("base", glb_root_pose(), -1), {node});
}

TEST(GlbFile, ConvertsColoursFromSrgbToLinear) {
  const Glb glb(a_file(a_triangle()));
  EXPECT_EQ(glb.at<std::uint16_t>("COLOR_0", 0), 0);
  EXPECT_EQ(glb.at<std::uint16_t>("COLOR_0", 4), 65535);
  // sRGB 188 is the middle grey: 0.5029 in linear light; 10 lies on the straight part:
  // 10/255/12.92.
  EXPECT_NEAR(glb.at<std::uint16_t>("COLOR_0", 8) / 65535.0, 0.5029, 1e-4);
  EXPECT_NEAR(glb.at<std::uint16_t>("COLOR_0", 9) / 65535.0, 10.0 / 255.0 / 12.92, 1e-5);
}

TEST(GlbFile, NormalisesEveryNormal) {
  const Glb glb(a_file(a_triangle()));
  for (std::size_t vertex = 0; vertex < 3; ++vertex) {
    double square = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float component = glb.at<float>("NORMAL", vertex * 3 + axis);
      square += double(component) * component;
    }
    EXPECT_NEAR(square, 1.0, 1e-6) << vertex;
  }
}

TEST(GlbFile, HasTheBoundsOfItsPositions) {
  const Glb glb(a_file(a_triangle()));
  const json& accessor = glb.document["accessors"][0];
  EXPECT_EQ(accessor["min"], json::parse("[0.0, 0.0, -3.0]"));
  EXPECT_EQ(accessor["max"], json::parse("[1.0, 2.0, 0.0]"));
}

TEST(GlbFile, IsUprightInAYUpViewer) {
  const Eigen::Vector3d up = glb_root_pose() * Eigen::Vector3d::UnitZ().eval();
  EXPECT_LT((up - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_EQ(Glb(a_file(a_triangle())).document["scenes"][0]["nodes"], json::parse("[1]"));
}

TEST(GlbFile, IsReadBackNodeByNode) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder.path() / "a.glb", a_file(a_triangle())));
  const auto content = read_glb(folder.path() / "a.glb");
  ASSERT_TRUE(content) << content.error().to_string();
  EXPECT_EQ(content->root, "base");
  ASSERT_EQ(content->nodes.size(), 1U);
  EXPECT_EQ(content->nodes[0].name, "part");
  EXPECT_EQ(content->nodes[0].triangles, 1U);
  EXPECT_EQ(content->nodes[0].T_parent_node.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(GlbFile, RejectsATruncatedFile) {
  const TemporaryFolder folder;
  const std::string whole = a_file(a_triangle());
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    ASSERT_TRUE(write_file(folder.path() / "a.glb", whole.substr(0, size)));
    EXPECT_FALSE(read_glb(folder.path() / "a.glb")) << size;
  }
}

TEST(GlbFile, RejectsAnIndexOutOfRange) {
  const TemporaryFolder folder;
  TriangleMesh mesh = a_triangle();
  mesh.triangles.push_back({0, 1, 3});
  ASSERT_TRUE(write_file(folder.path() / "a.glb", a_file(mesh)));
  EXPECT_FALSE(read_glb(folder.path() / "a.glb"));
}

TEST(GlbFile, SeparatesTheTextureOfANode) {
  const TemporaryFolder folder;
  const std::string jpeg = "\xFF\xD8 not a whole image";
  GlbWriter writer;
  const int mesh =
      writer.add_textured_mesh(kStaticMeshNode, a_triangle(), {{0, 0}, {1, 0}, {0, 1}}, jpeg);
  const int node = writer.add_node(kStaticMeshNode, Pose(), mesh);
  const std::string bytes = writer.finish(writer.add_node("base", glb_root_pose(), -1), {node});
  // A viewer would multiply the texture with the vertices' colours.
  EXPECT_FALSE(Glb(bytes).document["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
  ASSERT_TRUE(write_file(folder.path() / "a.glb", bytes));
  const auto separate = read_node_glb(folder.path() / "a.glb", kStaticMeshNode, "../texture.jpg");
  ASSERT_TRUE(separate) << separate.error().to_string();
  EXPECT_EQ(separate->texture, jpeg);
  EXPECT_EQ(separate->triangles, 1U);
  const Glb glb(separate->bytes);
  EXPECT_EQ(glb.document["images"], json::parse(R"([{"uri": "../texture.jpg"}])"));
  EXPECT_EQ(glb.document["buffers"][0]["byteLength"], glb.buffer.size());
  EXPECT_EQ(glb.at<float>("TEXCOORD_0", 2), 1.0F);
  const auto absent = read_node_glb(folder.path() / "a.glb", kUnseenSupportNode, "t.jpg");
  ASSERT_TRUE(absent) << absent.error().to_string();
  EXPECT_EQ(absent->triangles, 0U);
}

TEST(GlbFile, HasATextureForEachMesh) {
  const TemporaryFolder folder;
  const std::vector<std::string> jpegs = {"\xFF\xD8 of the scan", "\xFF\xD8 of a box, longer"};
  const std::vector<std::string> names = {kStaticMeshNode, "box"};
  GlbWriter writer;
  std::vector<int> nodes;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int mesh =
        writer.add_textured_mesh(names[i], a_triangle(), {{0, 0}, {1, 0}, {0, 1}}, jpegs[i]);
    nodes.push_back(writer.add_node(names[i], Pose(), mesh));
  }
  const int plain = writer.add_mesh("plain", a_box({1, 2, 3}), GlbMaterial::body);
  nodes.push_back(writer.add_node("plain", Pose(), plain));
  ASSERT_TRUE(write_file(folder.path() / "a.glb",
                         writer.finish(writer.add_node("base", glb_root_pose(), -1), nodes)));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto separate = read_node_glb(folder.path() / "a.glb", names[i], "texture.jpg");
    ASSERT_TRUE(separate) << separate.error().to_string();
    EXPECT_EQ(separate->texture, jpegs[i]) << names[i];
    const Glb glb(separate->bytes);
    EXPECT_EQ(glb.document["meshes"].size(), 1U);
    EXPECT_EQ(glb.document["images"], json::parse(R"([{"uri": "texture.jpg"}])"));
    EXPECT_EQ(glb.at<float>("TEXCOORD_0", 2), 1.0F);
    EXPECT_EQ(glb.at<float>("POSITION", 3), 1.0F);
  }
  const auto box = read_node_glb(folder.path() / "a.glb", "plain", "texture.jpg");
  ASSERT_TRUE(box) << box.error().to_string();
  EXPECT_TRUE(box->texture.empty());
  EXPECT_FALSE(Glb(box->bytes).document.contains("images"));
  EXPECT_EQ(box->triangles, 12U);
}

TEST(DisplayMesh, HasSharpEdgesForABox) {
  const TriangleMesh sharp = with_sharp_edges(a_box({1, 2, 3}));
  EXPECT_EQ(sharp.vertices.size(), 24U);
  EXPECT_EQ(sharp.triangles.size(), 12U);
  for (const Eigen::Vector3f& normal : sharp.normals) {
    EXPECT_NEAR(normal.cwiseAbs().maxCoeff(), 1.0F, 1e-6F);
  }
  EXPECT_NEAR(signed_volume(sharp), 6.0, 1e-6);
}

TEST(DisplayMesh, DoesNotSplitASmoothSurface) {
  const TriangleMesh table = a_level_square({0, 0, 0}, 1.0, 10);
  EXPECT_EQ(with_sharp_edges(table).vertices.size(), table.vertices.size());
}

}  // namespace
}  // namespace pcavr
