// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Files that declare more than they contain are rejected before memory is allocated for it.
#include <bit>
#include <chrono>
#include <cstdint>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "pcavr/base/model/cad_model.hpp"

#include "support/sanitizers.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

/// [s] A rejection takes milliseconds; a loop over a declared count takes minutes.
constexpr double kTimeout = 5.0;

class DeclaredSize : public testing::Test {
 protected:
  [[nodiscard]] fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
    return folder_.path() / name;
  }

  void expect_rejected(const fs::path& file, const std::string& reason) const {
    const auto begin = std::chrono::steady_clock::now();
    const Expected<TriangleMesh> mesh = read_mesh(file);
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(passed.count(), kTimeout) << file;
    ASSERT_FALSE(mesh.has_value()) << file;
    EXPECT_NE(mesh.error().to_string().find(reason), std::string::npos) << mesh.error().to_string();
  }

  TemporaryFolder folder_;
};

std::string ply(const std::string& format, const std::string& vertices, const std::string& faces,
                const std::string& content) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n" + content;
}

const char kTriangle[] = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

std::string little_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

TEST_F(DeclaredSize, OfAnAsciiPlyIsChecked) {
  EXPECT_TRUE(read_mesh(write("a.ply", ply("ascii", "3", "1", kTriangle))).has_value());
  for (const char* vertices : {"100000000000000", "4000000000", "1000"}) {
    expect_rejected(write("v.ply", ply("ascii", vertices, "1", kTriangle)), "has room for");
  }
  expect_rejected(write("f.ply", ply("ascii", "3", "100000000000000", kTriangle)), "has room for");
}

TEST_F(DeclaredSize, OfABinaryPlyIsChecked) {
  const std::string content(3 * 12 + 13, '\0');
  for (const char* vertices : {"100000000000000", "5"}) {
    expect_rejected(write("v.ply", ply("binary_little_endian", vertices, "1", content)),
                    "has room for");
  }
}

TEST_F(DeclaredSize, OfABinaryPlyIsRightWhateverItsFirstByteIs) {
  // A line feed there was taken for the end of the header's line.
  for (std::uint32_t first = 0; first < 256; ++first) {
    const float x = std::bit_cast<float>(0x3f800000U + first);  // 1.00000 to 1.00003
    std::string data = little_endian(std::bit_cast<std::uint32_t>(x)) + std::string(8, '\0');
    for (const float y : {2.0F, 0.0F, 0.0F, 0.0F, 2.0F, 0.0F}) {
      data += little_endian(std::bit_cast<std::uint32_t>(y));
    }
    data += '\3' + little_endian(0) + little_endian(1) + little_endian(2);
    const auto mesh = read_mesh(write("b.ply", ply("binary_little_endian", "3", "1", data)));
    ASSERT_TRUE(mesh.has_value()) << first << ": " << mesh.error().to_string();
    ASSERT_EQ(mesh->vertices.size(), 3U) << first;
    EXPECT_NEAR(mesh->vertices[0].x(), x, 2e-7F) << first;
  }
}

TEST_F(DeclaredSize, ThatIsNotACountIsRejected) {
  for (const char* vertices : {"-1", "1e14", "99999999999999999999999", "x"}) {
    expect_rejected(write("v.ply", ply("ascii", vertices, "1", kTriangle)), "its header declares");
  }
}

#ifndef PCAVR_IS_SANITIZED  // the reader catches std::bad_alloc
TEST_F(DeclaredSize, OfAListInABinaryPlyIsRejected) {
  std::string header = ply("binary_little_endian", "3", "1", "");
  header.replace(header.find("uchar"), 5, "uint");
  expect_rejected(write("l.ply", header + std::string(36, '\0') + little_endian(0xFFFFFFF0)),
                  "l.ply");
}
#endif

TEST_F(DeclaredSize, OfAnStlIsChecked) {
  expect_rejected(
      write("a.stl", std::string(80, ' ') + little_endian(0xFFFFFFFF) + std::string(100, '\0')),
      "has room for 2");
}

std::string glb(const std::string& json_text, std::uint32_t declared_surplus = 0) {
  std::string text = json_text;
  while (text.size() % 4 != 0) text += ' ';
  const auto size = static_cast<std::uint32_t>(20 + text.size());
  return "glTF" + little_endian(2) + little_endian(size + declared_surplus) +
         little_endian(static_cast<std::uint32_t>(text.size()) + declared_surplus) + "JSON" + text;
}

TEST_F(DeclaredSize, OfAGlbIsChecked) {
  expect_rejected(write("a.glb", glb("{}", 1000)), "and the file has");
}

TEST_F(DeclaredSize, OfAnAccessorInAGlbIsRejected) {
  const std::string document =
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("accessors":[{"componentType":5126,"type":"VEC3","count":4000000000,)"
      R"("bufferView":0}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("buffers":[{"byteLength":36}]})";
  expect_rejected(write("accessor.glb", glb(document)), "accessor.glb");
}

TEST_F(DeclaredSize, OfADeeplyNestedGltfDocumentIsRejected) {
  const std::string nested = R"({"asset":{"version":"2.0"},"x":)" + std::string(500'000, '[') +
                             std::string(500'000, ']') + '}';
  expect_rejected(write("deep.glb", glb(nested)), "nested too deeply");
  expect_rejected(write("deep.gltf", nested), "nested too deeply");
}

TEST_F(DeclaredSize, OfAnExternalBufferRequiresARegularFile) {
  const std::string document =
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("accessors":[{"componentType":5126,"type":"VEC3","count":3,"bufferView":0}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("buffers":[{"byteLength":36,"uri":"pipe.bin"}]})";
  ASSERT_EQ(::mkfifo((folder_.path() / "pipe.bin").c_str(), 0600), 0);
  expect_rejected(write("a.gltf", document), "a.gltf");
}

TEST_F(DeclaredSize, OfAPipeDoesNotBlock) {
  const fs::path pipe = folder_.path() / "pipe.obj";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_rejected(pipe, "named pipe");
}

}  // namespace
}  // namespace pcavr
