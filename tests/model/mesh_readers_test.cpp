// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/mesh_readers.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/model/cad_model.hpp"

#include "base/model/assimp_scene.hpp"
#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_repair.hpp"
#include "support/meshes.hpp"
#include "support/shared_data.hpp"

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

/// The mesh with few digits, which any reader parses to the same numbers.
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

class MeshReaders : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("mesh_readers_" +
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

/// The shape for a CAD model: vertices welded, normals and colours removed.
TriangleMesh shape_of(TriangleMesh mesh) {
  mesh.normals.clear();
  mesh.colors.clear();
  return weld_vertices(mesh);
}

/// Reads a mesh by the reader of the file's type.
TriangleMesh read(const fs::path& file) {
  if (file.extension() == ".stl") return read_stl_mesh(file);
  if (file.extension() == ".ply") return read_ply_mesh(file);
  return read_obj_mesh(file, MeshContent::kShape);
}

/// The message of the error, in one line.
std::string fault_of(const fs::path& file) {
  const Expected<TriangleMesh> mesh = read_mesh(file);
  return mesh ? "no error" : mesh.error().to_string();
}

TEST_F(MeshReaders, ReadEveryTypeLikeAssimp) {
  const TriangleMesh ball = sphere_mesh(0.1F, 30);
  for (const fs::path& file : {write("ball.stl", stl_of(ball)), write("ball.ply", ply_of(ball)),
                               write("ball.obj", obj_of(ball))}) {
    const TriangleMesh one = shape_of(read(file));
    const TriangleMesh other = shape_of(read_assimp_scene(file));
    EXPECT_EQ(one.vertices, other.vertices) << file;
    EXPECT_EQ(one.triangles, other.triangles) << file;
  }
}

TEST_F(MeshReaders, WeldTheCornersOfAnStl) {
  const TriangleMesh ball = sphere_mesh(0.1F, 30);
  EXPECT_EQ(read_stl_mesh(write("ball.stl", stl_of(ball))).vertices.size(), ball.vertices.size());
}

TEST_F(MeshReaders, TriangulatePolygonsAndResolveNegativeIndices) {
  const TriangleMesh square = read(
      write("square.obj", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv +0 1 0\r\nf -4 -3 \\\r\n-2 -1\r\n"));
  EXPECT_EQ(square.triangles.size(), 2U);
  EXPECT_NEAR(surface_area(square), 1.0, 1e-6);
}

TEST_F(MeshReaders, RejectTruncatedFiles) {
  const TriangleMesh ball = sphere_mesh(0.1F, 4);
  for (const auto& [name, bytes] :
       {std::pair("ball.stl", stl_of(ball)), std::pair("ball.ply", ply_of(ball))}) {
    for (std::size_t size = 0; size < bytes.size(); size += 37) {
      EXPECT_NE(fault_of(write(name, bytes.substr(0, size))), "no error") << name << ' ' << size;
    }
  }
}

TEST_F(MeshReaders, NameTheLineOfAnObjThatIsWrong) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  for (const auto& [more, message] :
       {std::pair("f 1 2 4\n", ":4: is not a readable mesh: a face refers to vertex 4 of the 3"),
        std::pair("f 0 1 2\n", ":4: is not a readable mesh: a face refers to vertex 0"),
        std::pair("f 1 2 x\n", ":4: is not a readable mesh: 'x' is not an index"),
        std::pair("v 1 2 nan\nf 1 2 4\n", "vertex 2: has a coordinate that is not finite"),
        std::pair("v 1 2\nf 1 2 3\n", ":4: is not a readable mesh: a vertex has not three"),
        std::pair("v 1 2 3 0\nf 1 2 3\n", ":4: is not a readable mesh: a vertex has the weight 0"),
        std::pair("f 1//1 2 3\n", ":4: is not a readable mesh: a face refers to normal 1")}) {
    const std::string line = fault_of(write("odd.obj", square + more));
    EXPECT_NE(line.find(message), std::string::npos) << line;
  }
}

TEST_F(MeshReaders, IgnoreVerticesThatNoTriangleHas) {
  const auto cad =
      read_cad_model(write("odd.obj", obj_of(sphere_mesh(0.01F, 4)) + "v 1e30 nan 0\n"), "a");
  ASSERT_TRUE(cad) << cad.error().to_string();
  EXPECT_NEAR(bounds(cad->mesh_object.vertices).max().z(), 100.0F, 1e-3F);
}

TEST_F(MeshReaders, BoundThePolygonsOfAHostileFile) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf";
  for (int i = 0; i < 5000; ++i) text += " 1 2 3";
  EXPECT_NE(fault_of(write("many.obj", text + "\n")).find("a face has 15000 corners"),
            std::string::npos);
}

/// A tetrahedron of 1/6 m^3. `more[i]` is put before line i of the header.
std::string ply_text(const std::vector<std::string>& more) {
  const std::vector<std::string> lines{"format ascii 1.0",
                                       "element vertex 4",
                                       "property float x",
                                       "property double y",
                                       "property float z",
                                       "element face 4",
                                       "property list uchar int vertex_indices",
                                       "end_header"};
  std::string text = "ply\n";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += (i < more.size() ? more[i] : "") + lines[i] + "\n";
  }
  return text + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
}

TEST_F(MeshReaders, AcceptCommentsOnAnyLineOfAPlyHeader) {
  for (std::size_t at = 0; at < 8; ++at) {
    std::vector<std::string> more(8);
    more[at] = "comment of any kind\nobj_info 1 property\n";
    const auto cad = read_cad_model(write("a.ply", ply_text(more)), "a");
    ASSERT_TRUE(cad) << at << ' ' << cad.error().to_string();
    EXPECT_NEAR(cad->volume, 1.0 / 6.0, 1e-7) << at;
  }
}

TEST_F(MeshReaders, NameWhatIsWrongInAPlyHeader) {
  for (const auto& [line, message] :
       {std::pair("element vertex 9\n", "it has two elements 'vertex'"),
        std::pair("property quad q\n", "'quad' is not a type of numbers"),
        std::pair("nonsense\n", "'nonsense' is not a keyword of a PLY header"),
        std::pair("element a -1\n", "its header declares '-1' of a")}) {
    const std::string fault =
        fault_of(write("odd.ply", ply_text({"", "", "", "", "", "", "", line})));
    EXPECT_NE(fault.find(message), std::string::npos) << fault;
  }
}

TEST_F(MeshReaders, ReadABigEndianPlyWithOtherListsAndElements) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement material 1\nproperty list uchar short s\n"
      "element vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement face 1\n"
      "property list uchar float texcoord\nproperty list uchar ushort vertex_index\nend_header\n";
  const auto append_big = [&](auto number) {
    std::string raw(reinterpret_cast<const char*>(&number), sizeof number);
    bytes.append(raw.rbegin(), raw.rend());
  };
  append_big(std::uint8_t{1});
  append_big(std::int16_t{7});
  for (const double x : {0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0, 0.0}) append_big(x);
  append_big(std::uint8_t{1});
  append_big(0.5F);
  append_big(std::uint8_t{3});
  for (std::uint16_t i = 0; i < 3; ++i) append_big(i);
  EXPECT_NEAR(surface_area(read(write("big.ply", bytes))), 3.0, 1e-6);
}

TEST_F(MeshReaders, ReadAnAsciiStl) {
  std::string text = "solid a part\n";
  for (const char* facet : {"0 0 0\n 1 0 0\n 0 1 0", "0 0 0\n 0 1 0\n 0 0 1"}) {
    std::string corners = std::string("VERTEX ") + facet;
    for (std::size_t at = 0; (at = corners.find("\n ", at)) != corners.npos; at += 8) {
      corners.replace(at, 2, "\nvertex ");
    }
    text += " facet normal 0 0 1\n  outer loop\n" + corners + "\n  endloop\n endfacet\n";
  }
  EXPECT_NEAR(surface_area(read(write("a.stl", text + "endsolid\n"))), 1.0, 1e-6);
  EXPECT_NE(fault_of(write("b.stl", text + "facet\nvertex 0 0\n")).find("b.stl:17: "),
            std::string::npos);
}

// Files on which the library crashes that used to read them in this process.
TEST_F(MeshReaders, EndWithALineOnHostileFiles) {
  PCAVR_NEEDS_SHARED_DATA("faults/hostile");
  for (const auto& [name, message] :
       {std::pair("double_free.ply", ":9: is not a readable mesh: it has two elements 'vertex'"),
        std::pair("abort.dae",
                  "is not a readable mesh: the library that reads this type crashed")}) {
    const std::string line = fault_of(shared_data("faults/hostile") / name);
    EXPECT_NE(line.find(message), std::string::npos) << line;
  }
  // Its skin has no inverse bind matrices, which does not matter.
  EXPECT_TRUE(read_mesh(shared_data("faults/hostile/segfault.gltf")));
}

TEST_F(MeshReaders, ReadADaeWhateverItsLightsAndNodesAreCalled) {
  const std::string text =
      R"(<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)"
      R"(<unit meter="0.5"/></asset><library_lights><light id="l"><technique_common><ambient>)"
      R"(<color>1 1 1</color></ambient></technique_common></light></library_lights>)"
      R"(<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" )"
      R"(count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor )"
      R"(source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" )"
      R"(type="float"/><param name="Z" type="float"/></accessor></technique_common></source>)"
      R"(<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4">)"
      R"(<input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p>)"
      R"(</triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene )"
      R"(id="s"><node id="n" name="n"><instance_geometry url="#g"/></node><node id="l1" name="x">)"
      R"(<instance_light url="#l"/></node><node id="l1" name="x"><instance_light url="#l"/></node>)"
      R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene>)"
      R"(</COLLADA>)";
  const auto cad = read_cad_model(write("a.dae", text), "a");
  ASSERT_TRUE(cad) << cad.error().to_string();
  EXPECT_NEAR(cad->volume, 0.125 / 6.0, 1e-7);
}

}  // namespace
}  // namespace pcavr::model
