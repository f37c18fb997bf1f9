// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/shape_file.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/core/output.hpp"

#include "model/mesh_file.hpp"
#include "model/mesh_repair.hpp"
#include "support/meshes.hpp"

namespace pcavr::model {
namespace {

namespace fs = std::filesystem;
using test::sphere_mesh;

template <typename Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string stl_of(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) append(bytes, 0.0F);
    for (const std::uint32_t v : t) {
      for (int k = 0; k < 3; ++k) append(bytes, mesh.vertices[v][k]);
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string ply_of(const TriangleMesh& mesh) {
  std::ostringstream header;
  header
      << "ply\nformat binary_little_endian 1.0\ncomment a ball\nelement vertex "
      << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  std::string bytes = header.str();
  for (const Eigen::Vector3f& p : mesh.vertices) {
    for (int k = 0; k < 3; ++k) append(bytes, p[k]);
    append(bytes, std::uint8_t{7});
  }
  for (const auto& t : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    for (const std::uint32_t v : t) append(bytes, v);
  }
  return bytes;
}

/// With few digits, which any reader parses to the same numbers.
std::string obj_of(const TriangleMesh& mesh) {
  std::ostringstream text;
  text << "# a ball\no ball\n";
  for (const Eigen::Vector3f& p : mesh.vertices) {
    text << "v " << std::lround(1e4F * p.x()) << ' ' << std::lround(1e4F * p.y()) << ' '
         << std::lround(1e4F * p.z()) << '\n';
  }
  text << "vn 0 0 1\ns off\n";
  for (const auto& [a, b, c] : mesh.triangles) {
    text << "f " << a + 1 << "//1 " << b + 1 << "//1 " << c + 1 << "//1\n";
  }
  return text.str();
}

class ShapeFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("shape_file_" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  fs::path folder_;
};

/// As for a CAD model: vertices welded, normals and colours removed.
TriangleMesh shape_of(TriangleMesh mesh) {
  mesh.normals.clear();
  mesh.colors.clear();
  return weld_vertices(mesh);
}

TEST_F(ShapeFile, ReadsEveryTypeLikeAssimp) {
  const TriangleMesh ball = sphere_mesh(0.1F, 30);
  for (const fs::path& file : {write("ball.stl", stl_of(ball)), write("ball.ply", ply_of(ball)),
                               write("BALL.OBJ", obj_of(ball))}) {
    const std::optional<TriangleMesh> direct = read_shape(file);
    ASSERT_TRUE(direct) << file;
    const Expected<TriangleMesh> imported = import_mesh(file);
    ASSERT_TRUE(imported) << file;
    const TriangleMesh one = shape_of(*direct);
    const TriangleMesh other = shape_of(*imported);
    EXPECT_EQ(one.vertices, other.vertices) << file;
    EXPECT_EQ(one.triangles, other.triangles) << file;
  }
}

TEST_F(ShapeFile, WeldsTheCornersOfAnStlWhileReading) {
  const TriangleMesh ball = sphere_mesh(0.1F, 30);
  const auto read = read_shape(write("ball.stl", stl_of(ball)));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->vertices.size(), ball.vertices.size());
}

TEST_F(ShapeFile, TriangulatesPolygonsAndResolvesNegativeIndices) {
  const auto read = read_shape(
      write("square.obj", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv +0 1 0\r\nf -4 -3 -2 -1\r\n"));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->triangles.size(), 2U);
  EXPECT_NEAR(surface_area(*read), 1.0, 1e-6);
}

TEST_F(ShapeFile, RejectsTruncatedFiles) {
  const TriangleMesh ball = sphere_mesh(0.1F, 4);
  for (const auto& [name, bytes] :
       {std::pair("ball.stl", stl_of(ball)), std::pair("ball.ply", ply_of(ball))}) {
    for (std::size_t size = 0; size < bytes.size(); size += 37) {
      EXPECT_FALSE(read_shape(write(name, bytes.substr(0, size)))) << name << ' ' << size;
    }
  }
}

TEST_F(ShapeFile, RejectsUnsupportedContent) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  for (const char* more :
       {"f 1 2 4\n", "f 0 1 2\n", "f 1 2 x\n", "v 1 2 nan\nf 1 2 3\n", "v 1 2\nf 1 2 3\n",
        "v 1 2 3 2\nf 1 2 3\n", "curv2 1 2\nf 1 2 3\n", "f 1 2 \\\n3\n"}) {
    EXPECT_FALSE(read_shape(write("odd.obj", square + more))) << more;
  }
  const std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (const char* more :
       {"element vertex 100000000000000\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n",
        "element vertex 1\nproperty double x\nproperty double y\nproperty double z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n",
        "element vertex 1\nproperty float x\nproperty float y\nend_header\n", "element nothing\n",
        "property float x\nend_header\n"}) {
    EXPECT_FALSE(read_shape(write("odd.ply", header + more + std::string(100, '\0')))) << more;
  }
  EXPECT_FALSE(read_shape(folder_ / "nowhere.stl"));
  EXPECT_FALSE(read_shape(write("ball.glb", "glTF")));
}

}  // namespace
}  // namespace pcavr::model
