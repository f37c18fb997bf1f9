// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/model/cad_model.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// A tetrahedron of edge `scale`, with indices of 16 bits behind the positions.
template <typename Number>
std::string tetrahedron(Number scale, std::size_t stride) {
  std::string bytes;
  for (int v = 0; v < 4; ++v) {
    std::string row(stride, '\0');
    for (int axis = 0; axis < 3; ++axis) {
      const Number x = v == axis + 1 ? scale : Number{0};
      std::memcpy(row.data() + static_cast<std::size_t>(axis) * sizeof(Number), &x, sizeof x);
    }
    bytes += row;
  }
  for (const char i : std::string("021013123032")) bytes += {static_cast<char>(i - '0'), '\0'};
  return bytes;
}

struct GltfParts {
  std::string binary = tetrahedron(1.0F, 12);
  int stride = 12;
  std::string component = "5126";
  std::string node = R"({"mesh":0})";
  std::string extensions = {};  ///< members of the document, with a comma behind each
  std::string primitives = {};  ///< more of them, with a comma before each
  std::string buffer = {};      ///< members of the buffer, with a comma before each
};

std::string document_of(const GltfParts& parts) {
  const std::string indices_at = std::to_string(4 * parts.stride);
  return R"({"asset":{"version":"2.0"},)" + parts.extensions +
         R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + parts.node +
         R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1})" +
         parts.primitives + R"(]}],"buffers":[{"byteLength":)" +
         std::to_string(parts.binary.size()) + parts.buffer +
         R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + indices_at + R"(,"byteStride":)" +
         std::to_string(parts.stride) + R"(},{"buffer":0,"byteOffset":)" + indices_at +
         R"(,"byteLength":24}],"accessors":[{"bufferView":0,"componentType":)" + parts.component +
         R"(,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":12,)" +
         R"("type":"SCALAR"}]})";
}

void append_word(std::string& bytes, std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}

std::string glb_of(const GltfParts& parts) {
  std::string text = document_of(parts);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append_word(bytes, 2);
  append_word(bytes, 28 + text.size() + parts.binary.size());
  append_word(bytes, text.size());
  bytes += "JSON" + text;
  append_word(bytes, parts.binary.size());
  return bytes + std::string("BIN\0", 4) + parts.binary;
}

class GltfReader : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path write(const std::string& name,
                                            const std::string& bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
    return folder_.path() / name;
  }
  [[nodiscard]] double volume_of(const GltfParts& parts) const {
    const auto cad = read_cad_model(write("a.glb", glb_of(parts)), "a");
    EXPECT_TRUE(cad) << cad.error().to_string();
    return cad ? cad->volume : 0.0;
  }
  [[nodiscard]] std::string fault_of(const GltfParts& parts) const {
    const auto mesh = read_mesh(write("a.glb", glb_of(parts)));
    return mesh ? "no error" : mesh.error().to_string();
  }

  TemporaryFolder folder_;
};

constexpr double kTetrahedron = 1.0 / 6.0;  // [m^3] of edge 1 m

TEST_F(GltfReader, QuantisedCoordinatesAreNumbersNotBits) {
  const std::string quantised = R"("extensionsRequired":["KHR_mesh_quantization"],)";
  GltfParts millimetres{.binary = tetrahedron(std::int16_t{1000}, 8),
                        .stride = 8,
                        .component = "5122",
                        .node = R"({"mesh":0,"scale":[0.001,0.001,0.001]})",
                        .extensions = quantised};
  EXPECT_NEAR(volume_of(millimetres), kTetrahedron, 1e-6);
  GltfParts normalised{.binary = tetrahedron(std::int16_t{32767}, 8),
                       .stride = 8,
                       .component = R"(5122,"normalized":true)",
                       .extensions = quantised};
  EXPECT_NEAR(volume_of(normalised), kTetrahedron, 1e-6);
  GltfParts bytes{.binary = tetrahedron(std::uint8_t{255}, 4),
                  .stride = 4,
                  .component = R"(5121,"normalized":true)",
                  .node = R"({"mesh":0,"matrix":[2,0,0,0,0,2,0,0,0,0,2,0,5,6,7,1]})",
                  .extensions = quantised};
  EXPECT_NEAR(volume_of(bytes), 8.0 * kTetrahedron, 1e-5);
}

TEST_F(GltfReader, RequiredExtensionsThatAreNotReadAreNamed) {
  for (const std::string name : {"EXT_meshopt_compression", "KHR_draco_mesh_compression",
                                 "EXT_mesh_gpu_instancing", "ACME_shape"}) {
    GltfParts parts;
    parts.extensions = R"("extensionsRequired":[")" + name + R"("],)";
    EXPECT_NE(fault_of(parts).find("it requires the glTF extension " + name), std::string::npos);
    parts.extensions = R"("extensionsUsed":[")" + name + R"("],)";
    EXPECT_NEAR(volume_of(parts), kTetrahedron, 1e-6) << name;
  }
  GltfParts looks;
  looks.extensions = R"("extensionsRequired":["KHR_texture_basisu","KHR_materials_unlit"],)";
  EXPECT_NEAR(volume_of(looks), kTetrahedron, 1e-6);
}

TEST_F(GltfReader, CamerasPointsLinesAndSkinsDoNotMatter) {
  GltfParts parts;
  parts.node =
      R"({"mesh":0,"skin":0,"camera":0,"children":[1,2]},{"name":"c","camera":7},{"name":"c"})";
  parts.extensions = R"("skins":[{"joints":[1]}],"cameras":[{}],)";
  parts.primitives =
      R"(,{"attributes":{"POSITION":0},"mode":0},{"attributes":{"POSITION":0},"mode":1})";
  EXPECT_NEAR(volume_of(parts), kTetrahedron, 1e-6);
}

TEST_F(GltfReader, ContradictionsAreNamed) {
  GltfParts loop;
  loop.node = R"({"mesh":0,"children":[0]})";
  EXPECT_NE(fault_of(loop).find("its node 0 has two parents"), std::string::npos);
  GltfParts lost;
  lost.node = R"({"mesh":9})";
  EXPECT_NE(fault_of(lost).find("number 9 of its meshes, of which it has 1"), std::string::npos);
  GltfParts large;
  large.stride = 13;
  EXPECT_NE(fault_of(large).find("buffer view"), std::string::npos);
  GltfParts infinite;
  infinite.node = R"({"mesh":0,"scale":[1e400,1,1]})";
  EXPECT_NE(fault_of(infinite), "no error");
}

TEST_F(GltfReader, BuffersAreReadFromTheFilesFolderOnly) {
  GltfParts parts;
  const auto file = write("part of it.bin", parts.binary);
  const auto fault_with = [&](const std::string& uri) {
    parts.buffer = R"(,"uri":")" + uri + '"';
    const auto mesh = read_mesh(write("a.gltf", document_of(parts)));
    return mesh ? "no error" : mesh.error().to_string();
  };
  EXPECT_EQ(fault_with("part%20of%20it.bin"), "no error");
  for (const std::string& uri : {"../" + folder_.path().filename().string() + "/part of it.bin",
                                 file.string(), std::string("http://a.b/c.bin")}) {
    EXPECT_NE(fault_with(uri).find("is not in the file's folder"), std::string::npos) << uri;
  }
  EXPECT_NE(fault_with("data:application/octet-stream;base64,AAAA").find("buffer of 3"),
            std::string::npos);
}

}  // namespace
}  // namespace pcavr
