// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/model/cad_model.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

#include "support/meshes.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using test::box_mesh;

class CadFiles : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& content) {
    const std::filesystem::path file = folder_.path() / name;
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }

 private:
  TemporaryFolder folder_;
};

const Eigen::Vector3f kSize(0.1F, 0.2F, 0.3F);
constexpr double kVolume = 0.006;

std::string as_obj(const TriangleMesh& mesh, int vertices_before = 0) {
  std::ostringstream text;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    text << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto index = [&](std::uint32_t i) { return static_cast<int>(i) + 1 + vertices_before; };
    text << "f " << index(a) << ' ' << index(b) << ' ' << index(c) << '\n';
  }
  return text.str();
}

template <typename Number>
void append_bytes(std::string& bytes, Number number) {
  char raw[sizeof(Number)];
  std::memcpy(raw, &number, sizeof(Number));
  bytes.append(raw, sizeof(Number));
}

std::string as_binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  append_bytes(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (int k = 0; k < 3; ++k) append_bytes(bytes, 0.0F);
    for (const std::uint32_t index : triangle) {
      for (const float x : mesh.vertices[index]) append_bytes(bytes, x);
    }
    append_bytes(bytes, std::uint16_t{0});
  }
  return bytes;
}

/// `node` is the JSON of the node's transform; colours are grey of the given linear value.
std::string as_glb(const TriangleMesh& mesh, const std::string& node, float linear_gray) {
  std::string binary;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    for (const float x : v) append_bytes(binary, x);
  }
  for (std::size_t i = 0; i < 3 * mesh.vertices.size(); ++i) append_bytes(binary, linear_gray);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) append_bytes(binary, index);
  }
  const std::size_t n = mesh.vertices.size();
  const std::size_t m = 3 * mesh.triangles.size();
  const auto low = bounds(mesh.vertices).min();
  const auto high = bounds(mesh.vertices).max();
  std::ostringstream json;
  json << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)"
       << node << R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1},)"
       << R"("indices":2}]}],"buffers":[{"byteLength":)" << binary.size()
       << R"(}],"bufferViews":[{"buffer":0,"byteLength":)" << 12 * n
       << R"(},{"buffer":0,"byteOffset":)" << 12 * n << R"(,"byteLength":)" << 12 * n
       << R"(},{"buffer":0,"byteOffset":)" << 24 * n << R"(,"byteLength":)" << 4 * m
       << R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" << n
       << R"(,"type":"VEC3","min":[)" << low.x() << ',' << low.y() << ',' << low.z()
       << R"(],"max":[)" << high.x() << ',' << high.y() << ',' << high.z()
       << R"(]},{"bufferView":1,"componentType":5126,"count":)" << n
       << R"(,"type":"VEC3"},{"bufferView":2,"componentType":5125,"count":)" << m
       << R"(,"type":"SCALAR"}]})";
  std::string header = json.str();
  header.resize((header.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append_bytes(bytes, std::uint32_t{2});
  append_bytes(bytes, static_cast<std::uint32_t>(12 + 8 + header.size() + 8 + binary.size()));
  append_bytes(bytes, static_cast<std::uint32_t>(header.size()));
  bytes += "JSON" + header;
  append_bytes(bytes, static_cast<std::uint32_t>(binary.size()));
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

std::string as_ply_with_colors() {
  return "ply\nformat ascii 1.0\nelement vertex 4\n"
         "property float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0 10 20 30\n1 0 0 40 50 60\n1 1 0 70 80 90\n0 1 0 255 128 0\n4 0 1 2 3\n";
}

void expect_box(const Expected<CadModel>& model) {
  ASSERT_TRUE(model) << model.error().to_string();
  EXPECT_NEAR(model->volume, kVolume, 1e-8);
  EXPECT_NEAR(model->centre_of_mass_object.norm(), 0.0, 1e-7);
  EXPECT_EQ(model->mesh_object.vertices.size(), 8U);
  EXPECT_EQ(model->mesh_object.triangles.size(), 12U);
  EXPECT_EQ(model->mesh_object.normals.size(), 8U);
  EXPECT_GT(signed_volume(model->mesh_object), 0.0);
  const Eigen::AlignedBox3f box = bounds(model->mesh_object.vertices);
  EXPECT_NEAR((box.max() - 0.5F * kSize).norm(), 0.0F, 1e-6F);
  EXPECT_NEAR((box.min() + 0.5F * kSize).norm(), 0.0F, 1e-6F);
}

TEST_F(CadFiles, ReadsAnObj) {
  expect_box(read_cad_model(write("box.obj", as_obj(box_mesh(kSize))), "box"));
}

TEST_F(CadFiles, ReadsCoordinatesInAUnit) {
  expect_box(read_cad_model(write("box.obj", as_obj(box_mesh(1000.0F * kSize))), "box", {}, 0.001));
}

TEST_F(CadFiles, GivesTheModelItsName) {
  EXPECT_EQ(read_cad_model(write("a.obj", as_obj(box_mesh(kSize))), "crate")->name, "crate");
}

TEST_F(CadFiles, ReadsTheExtensionInAnyCase) {
  expect_box(read_cad_model(write("BOX.OBJ", as_obj(box_mesh(kSize))), "box"));
}

TEST_F(CadFiles, MergesTheGroupsOfAnObj) {
  TriangleMesh lower = box_mesh(kSize);
  TriangleMesh upper = transformed(Pose::from_translation({0, 0, 1}), box_mesh(kSize));
  const auto model = read_cad_model(
      write("two.obj", "g lower\n" + as_obj(lower) + "g upper\n" + as_obj(upper, 8)), "two");
  ASSERT_TRUE(model) << model.error().to_string();
  EXPECT_NEAR(model->volume, 2 * kVolume, 1e-7);
  EXPECT_NEAR((model->centre_of_mass_object - Eigen::Vector3d(0, 0, 0.5)).norm(), 0.0, 1e-6);
}

TEST_F(CadFiles, TriangulatesTheQuadsOfAnObjWithFaceNormals) {
  const std::string text =
      "v -0.05 -0.1 -0.15\nv 0.05 -0.1 -0.15\nv 0.05 0.1 -0.15\nv -0.05 0.1 -0.15\n"
      "v -0.05 -0.1 0.15\nv 0.05 -0.1 0.15\nv 0.05 0.1 0.15\nv -0.05 0.1 0.15\n"
      "vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0\n"
      "f 1//1 4//1 3//1 2//1\nf 5//2 6//2 7//2 8//2\nf 1//3 2//3 6//3 5//3\n"
      "f 2//4 3//4 7//4 6//4\nf 3//5 4//5 8//5 7//5\nf 4//6 1//6 5//6 8//6\n";
  expect_box(read_cad_model(write("quads.obj", text), "box"));
}

TEST_F(CadFiles, WeldsTheVerticesOfAnStl) {
  expect_box(read_cad_model(write("box.stl", as_binary_stl(box_mesh(kSize))), "box"));
}

TEST_F(CadFiles, FlipsInwardWinding) {
  TriangleMesh mesh = box_mesh(kSize);
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  expect_box(read_cad_model(write("inside_out.stl", as_binary_stl(mesh)), "box"));
}

TEST_F(CadFiles, SubtractsACavity) {
  TriangleMesh mesh = box_mesh(kSize);
  TriangleMesh hole = box_mesh(0.5F * kSize);
  for (auto& triangle : hole.triangles) std::swap(triangle[0], triangle[1]);
  const auto model = read_cad_model(write("hollow.obj", as_obj(mesh) + as_obj(hole, 8)), "hollow");
  ASSERT_TRUE(model) << model.error().to_string();
  EXPECT_NEAR(model->volume, kVolume * 7.0 / 8.0, 1e-8);
}

// A rotation by 90 degrees about x and a translation.
TEST_F(CadFiles, AppliesTheNodeTransformsOfAGlb) {
  const auto model = read_cad_model(
      write("box.glb",
            as_glb(box_mesh(kSize),
                   R"(,"rotation":[0.70710678,0,0,0.70710678],"translation":[1,2,3])", 1.0F)),
      "box");
  ASSERT_TRUE(model) << model.error().to_string();
  EXPECT_NEAR((model->centre_of_mass_object - Eigen::Vector3d(1, 2, 3)).norm(), 0.0, 1e-6);
  const Eigen::Vector3f size = bounds(model->mesh_object.vertices).sizes();
  EXPECT_NEAR((size - Eigen::Vector3f(0.1F, 0.3F, 0.2F)).norm(), 0.0F, 1e-6F);
}

TEST_F(CadFiles, SwapsNoAxesOfAGlb) {
  expect_box(read_cad_model(write("box.glb", as_glb(box_mesh(kSize), "", 1.0F)), "box"));
}

TEST_F(CadFiles, KeepsTheWindingOutwardUnderAMirroringNode) {
  const auto mesh =
      read_mesh(write("mirror.glb", as_glb(box_mesh(kSize), R"(,"scale":[-1,1,1])", 1.0F)));
  ASSERT_TRUE(mesh) << mesh.error().to_string();
  EXPECT_NEAR(signed_volume(*mesh), kVolume, 1e-8);
}

// IEC 61966-2-1 puts the linear value 0.21404114 at one half of the sRGB range.
TEST_F(CadFiles, ConvertsTheLinearColorsOfAGlbToSrgb) {
  const auto mesh = read_mesh(write("gray.glb", as_glb(box_mesh(kSize), "", 0.21404114F)));
  ASSERT_TRUE(mesh) << mesh.error().to_string();
  ASSERT_EQ(mesh->colors.size(), mesh->vertices.size());
  EXPECT_NEAR(mesh->colors[0].g, 127.5, 0.5);
}

TEST_F(CadFiles, KeepsTheByteColorsOfAPly) {
  const auto mesh = read_mesh(write("quad.ply", as_ply_with_colors()));
  ASSERT_TRUE(mesh) << mesh.error().to_string();
  EXPECT_EQ(mesh->triangles.size(), 2U);
  ASSERT_EQ(mesh->vertices.size(), 4U);
  ASSERT_EQ(mesh->colors.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    if (mesh->vertices[i] == Eigen::Vector3f(0, 1, 0)) {
      EXPECT_EQ(mesh->colors[i], (Rgb8{255, 128, 0}));
    }
  }
}

TEST_F(CadFiles, KeepsTheVertexNormalsOfAnOpenMesh) {
  const auto mesh =
      read_mesh(write("tilted.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nf 1//1 2//1 3//1\n"));
  ASSERT_TRUE(mesh) << mesh.error().to_string();
  ASSERT_EQ(mesh->normals.size(), 3U);
  EXPECT_NEAR((mesh->normals[0] - Eigen::Vector3f(0, 0.6F, 0.8F)).norm(), 0.0F, 1e-6F);
}

// --- User errors ---------------------------------------------------------------------------------

void expect_error(const Error& error, const std::string& part) {
  EXPECT_NE(error.to_string().find(part), std::string::npos) << error.to_string();
  EXPECT_FALSE(error.file.empty());
  EXPECT_FALSE(error.hint.empty());
  EXPECT_EQ(error.to_string().find('\n'), std::string::npos);
}

TEST_F(CadFiles, ReportAMissingFile) {
  const auto model = read_cad_model("/nowhere/box.obj", "box");
  ASSERT_FALSE(model);
  expect_error(model.error(), "/nowhere/box.obj: mesh file is missing");
}

TEST_F(CadFiles, ReportAnUnknownType) {
  const auto mesh = read_mesh(write("box.step", "ISO-10303-21;"));
  ASSERT_FALSE(mesh);
  expect_error(mesh.error(), ".step");
}

TEST_F(CadFiles, ReportAnOpenSurface) {
  TriangleMesh mesh = box_mesh(kSize);
  mesh.triangles.pop_back();
  const auto file = write("open.obj", as_obj(mesh));
  const auto model = read_cad_model(file, "box");
  ASSERT_FALSE(model);
  expect_error(model.error(), "no volume: 3 edges are open");
  EXPECT_TRUE(read_mesh(file));
}

TEST_F(CadFiles, ReportASurfaceWithoutVolume) {
  const auto model =
      read_cad_model(write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n"), "flat");
  ASSERT_FALSE(model);
  expect_error(model.error(), "encloses no volume");
}

TEST_F(CadFiles, ReportAMeshWithoutTriangles) {
  for (const char* text : {"v 0 0 0\nv 1 0 0\n", "v 0 0 0\nv 1 0 0\nl 1 2\n",
                           "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"}) {
    const auto mesh = read_mesh(write("nothing.obj", text));
    ASSERT_FALSE(mesh) << text;
    expect_error(mesh.error(), "nothing.obj");
  }
}

TEST_F(CadFiles, ReportANonFiniteCoordinate) {
  TriangleMesh broken = box_mesh(kSize);
  broken.vertices[3].x() = std::numeric_limits<float>::quiet_NaN();
  const auto model = read_cad_model(write("nan.stl", as_binary_stl(broken)), "box");
  ASSERT_FALSE(model);
  expect_error(model.error(), "not finite");
}

TEST_F(CadFiles, RejectRandomBytesOfEveryType) {
  Random random(8);
  for (const char* extension : {".obj", ".stl", ".ply", ".glb", ".gltf"}) {
    std::string garbage;
    for (int i = 0; i < 3000; ++i) garbage += static_cast<char>(random.below(256));
    for (const std::string& content : {garbage, std::string(), std::string(200, '\0')}) {
      const auto mesh = read_mesh(write("garbage" + std::string(extension), content));
      ASSERT_FALSE(mesh) << extension;
      expect_error(mesh.error(), "garbage");
    }
  }
}

// assimp would never return.
TEST_F(CadFiles, RejectAPlyWhoseHeaderDoesNotEnd) {
  std::string content = as_ply_with_colors();
  content.replace(content.find("end_header\n"), 11, "end_header0");
  const auto mesh = read_mesh(write("endless.ply", content));
  ASSERT_FALSE(mesh);
  expect_error(mesh.error(), "header has no end");
}

// A truncated file is read or rejected; it does not crash, and a mesh that is read is valid.
TEST_F(CadFiles, HandleTruncatedFiles) {
  const TriangleMesh box = box_mesh(kSize);
  const std::vector<std::pair<std::string, std::string>> files = {
      {"cut.obj", as_obj(box)},
      {"cut.stl", as_binary_stl(box)},
      {"cut.glb", as_glb(box, "", 1.0F)},
      {"cut.ply", as_ply_with_colors()}};
  for (const auto& [name, content] : files) {
    for (std::size_t length = 0; length < content.size(); length += 13) {
      const auto mesh = read_mesh(write(name, content.substr(0, length)));
      if (mesh) {
        EXPECT_NO_THROW(SurfaceQuery{*mesh}) << name << ' ' << length;
      }
    }
  }
}

TEST(MakeCadModel, ThrowsContractErrorForANonFiniteVertex) {
  TriangleMesh broken = box_mesh(kSize);
  broken.vertices[3].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)make_cad_model(broken, "box", "here"), ContractError);
}

TEST(MakeCadModel, RejectsAnEmptyMesh) {
  EXPECT_FALSE(make_cad_model(TriangleMesh{}, "box", "here"));
}

}  // namespace
}  // namespace pcavr
