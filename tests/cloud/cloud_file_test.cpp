// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/cloud_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/raw_bytes.hpp"

#include "fuzz/targets.hpp"
#include "recordings/cloud/parse_formats.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string pcd_text(const std::string& fields, const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n" + fields + data;
}

constexpr char kXyz[] = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

RecordedCloud parsed(const std::string& bytes) {
  const Expected<RecordedCloud> cloud = parse_cloud(bytes, "the-file");
  if (!cloud) {
    ADD_FAILURE() << cloud.error().to_string();
    return {};
  }
  return *cloud;
}

void expect_error(const std::string& bytes, const std::string& message, int line = 0) {
  const Expected<RecordedCloud> cloud = parse_cloud(bytes, "the-file");
  ASSERT_FALSE(cloud.has_value());
  EXPECT_NE(cloud.error().message.find(message), std::string::npos) << cloud.error().to_string();
  EXPECT_EQ(cloud.error().file, "the-file");
  EXPECT_FALSE(cloud.error().hint.empty());
  if (line > 0) {
    EXPECT_EQ(cloud.error().line, line);
  }
}

PointCloud small_cloud() {
  return {.points = {{1, 2, 3}, {kNan, kNan, kNan}, {-4, 5, 6.5F}, {0.25F, 0, 1}},
          .normals = {{0, 0, -1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}},
          .colors = {{1, 2, 3}, {4, 5, 6}, {255, 0, 128}, {7, 8, 9}}};
}

void expect_same(const RecordedCloud& read, const PointCloud& written) {
  ASSERT_EQ(read.points.size(), written.points.size());
  for (std::size_t i = 0; i < written.points.size(); ++i) {
    if (std::isnan(written.points[i].x())) {
      EXPECT_TRUE(std::isnan(read.points[i].x()));
    } else {
      EXPECT_EQ(read.points[i], written.points[i]);
    }
  }
  EXPECT_EQ(read.colors, written.colors);
  EXPECT_EQ(read.normals, written.normals);
}

TEST(CloudFile, PcdRoundTripKeepsEverything) {
  const PointCloud cloud = small_cloud();
  const Pose viewpoint(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1.0, -2.0, 0.125});
  const RecordedCloud read = parsed(format_pcd(cloud, 2, viewpoint));
  expect_same(read, cloud);
  EXPECT_EQ(read.width, 2);
  EXPECT_EQ(read.height, 2);
  EXPECT_EQ(read.measured_points(), 3U);
  EXPECT_NEAR(translation_distance(read.T_cloud_sensor, viewpoint), 0.0, 1e-12);
  EXPECT_NEAR(rotation_distance(read.T_cloud_sensor, viewpoint), 0.0, 1e-7);
}

TEST(CloudFile, AsciiPcdWithPackedColorsAsFloatsAndIntegers) {
  // 4.2108e+06 is 0x4A807FC0 as a float's bits, of PCL's own documentation.
  const std::string as_float =
      pcd_text("FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n",
               "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n"
               "0.93773 0.33763 0 4.2108e+06\nnan nan nan 0\n");
  const RecordedCloud read = parsed(as_float);
  EXPECT_FLOAT_EQ(read.points[0].x(), 0.93773F);
  EXPECT_TRUE(std::isnan(read.points[1].x()));
  float value = 4.2108e+06F;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, 4);
  EXPECT_EQ(read.colors[0].r, (bits >> 16) & 255U);
  EXPECT_EQ(read.colors[0].b, bits & 255U);

  const RecordedCloud whole =
      parsed(pcd_text("FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n",
                      "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3 16711935\r\n"));
  EXPECT_EQ(whole.colors[0], (Rgb8{255, 0, 255}));
}

TEST(CloudFile, OtherTypesHistogramsAndIntensity) {
  std::string data;
  for (const double row : {0.0, 1.0}) {
    append_bytes(data, row + 1.0);  // x
    append_bytes(data, 2.0);        // y
    append_bytes(data, 3.0);        // z
    append_bytes(data, 7.0F);       // histogram
    append_bytes(data, 8.0F);
    append_bytes(data, static_cast<float>(row));  // intensity, 0 to 1
  }
  const RecordedCloud read = parsed(
      pcd_text("FIELDS x y z fpfh intensity\nSIZE 8 8 8 4 4\nTYPE F F F F F\nCOUNT 1 1 1 2 1\n",
               "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n" + data));
  EXPECT_EQ(read.points[1], Eigen::Vector3f(2, 2, 3));
  EXPECT_EQ(read.colors, (std::vector<Rgb8>{{0, 0, 0}, {255, 255, 255}}));
}

TEST(CloudFile, CompressedPcdIsFieldByField) {
  // Literals only, as a compressor may write them: 3 floats of x, of y, of z.
  std::string plain;
  for (const float number : {1.F, 2.F, 3.F, 4.F, 5.F, 6.F, 7.F, 8.F, 9.F})
    append_bytes(plain, number);
  std::string packed =
      std::string(1, char(31)) + plain.substr(0, 32) + std::string(1, char(3)) + plain.substr(32);
  std::string sizes;
  append_bytes(sizes, static_cast<std::uint32_t>(packed.size()));
  append_bytes(sizes, static_cast<std::uint32_t>(plain.size()));
  const std::string header =
      pcd_text(kXyz, "WIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA binary_compressed\n");
  const RecordedCloud read = parsed(header + sizes + packed);
  EXPECT_EQ(read.points[0], Eigen::Vector3f(1, 4, 7));
  EXPECT_EQ(read.points[2], Eigen::Vector3f(3, 6, 9));
  packed[0] = char(30);
  expect_error(header + sizes + packed, "corrupt");
}

TEST(CloudFile, LzfMatchesMayOverlap) {
  // "ab", then a match of 6 from 2 back.
  const std::string compressed{char(1), 'a', 'b', char(4 << 5), char(1)};
  EXPECT_EQ(decompress_lzf(compressed, 8), "abababab");
  EXPECT_FALSE(decompress_lzf(compressed, 7));
  EXPECT_FALSE(decompress_lzf(compressed, 9));
  const std::string before_start{char(0), 'a', char(1 << 5), char(5)};
  EXPECT_FALSE(decompress_lzf(before_start, 4));
}

TEST(CloudFile, PlyInEveryFormat) {
  const std::string properties =
      "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 0\nproperty list uchar int vertex_indices\nend_header\n";
  const RecordedCloud ascii = parsed("ply\nformat ascii 1.0\ncomment none\n" + properties +
                                     "1 2 3 4 5 6\n-1 0 2 255 0 9\n");
  EXPECT_EQ(ascii.points[1], Eigen::Vector3f(-1, 0, 2));
  EXPECT_EQ(ascii.colors[1], (Rgb8{255, 0, 9}));
  std::string little;
  std::string big;
  for (const float row : {1.0F, -1.0F}) {
    for (const float number : {row, 2.0F, 3.5F}) {
      append_bytes(little, number);
      std::string bytes;
      append_bytes(bytes, number);
      std::reverse(bytes.begin(), bytes.end());
      big += bytes;
    }
    little += "\x04\x05\x06";
    big += "\x04\x05\x06";
  }
  for (const auto& [format, data] :
       {std::pair{"binary_little_endian", little}, std::pair{"binary_big_endian", big}}) {
    const RecordedCloud read =
        parsed("ply\nformat " + std::string(format) + " 1.0\n" + properties + data);
    EXPECT_EQ(read.points[1], Eigen::Vector3f(-1, 2, 3.5F)) << format;
    EXPECT_EQ(read.colors[0], (Rgb8{4, 5, 6})) << format;
  }
}

/// PCL writes organised clouds so.
TEST(CloudFile, PlyWithCameraIsOrganised) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement camera 1\n";
  for (const char* name : {"view_px", "view_py", "view_pz", "x_axisx", "x_axisy", "x_axisz",
                           "y_axisx", "y_axisy", "y_axisz", "z_axisx", "z_axisy", "z_axisz",
                           "focal", "scalex", "scaley", "centerx", "centery"}) {
    text += "property float " + std::string(name) + '\n';
  }
  text += "property int viewportx\nproperty int viewporty\nproperty float k1\nend_header\n";
  text += "0 0 1\n1 0 1\n0 1 1\nnan nan nan\n1 2 3 0 1 0 -1 0 0 0 0 1 0 0 0 0 0 2 2 0\n";
  const RecordedCloud read = parsed(text);
  EXPECT_EQ(read.width, 2);
  EXPECT_EQ(read.height, 2);
  EXPECT_EQ(read.T_cloud_sensor.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_LT((read.T_cloud_sensor * Eigen::Vector3d::UnitX() - Eigen::Vector3d(1, 3, 3)).norm(),
            1e-9);
}

TEST(CloudFile, ZeroAndInfiniteCoordinatesAreNotMeasured) {
  const RecordedCloud read =
      parsed(pcd_text(kXyz, "WIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA ascii\n0 0 0\ninf 1 2\n0 0 1\n"));
  EXPECT_TRUE(std::isnan(read.points[0].x()));
  EXPECT_TRUE(std::isnan(read.points[1].y()));
  EXPECT_EQ(read.measured_points(), 1U);
}

/// Their fault is that they are empty, not that coordinates are missing.
TEST(CloudFile, CloudsOfNoPointsAreReadInEveryFormat) {
  for (const char* data : {"ascii", "binary"}) {
    const RecordedCloud cloud =
        parsed(pcd_text(kXyz, "WIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA " + std::string(data) + "\n"));
    EXPECT_EQ(cloud.measured_points(), 0U);
    EXPECT_FALSE(cloud.is_organised());
  }
  EXPECT_TRUE(parsed("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\n"
                     "property float y\nproperty float z\nend_header\n")
                  .points.empty());
}

TEST(CloudFile, EveryTruncationIsAnError) {
  const std::string pcd = format_pcd(small_cloud(), 2);
  for (std::size_t size = 0; size < pcd.size(); ++size) {
    const Expected<RecordedCloud> cloud = parse_cloud(pcd.substr(0, size), "f");
    EXPECT_FALSE(cloud.has_value()) << size;
  }
}

TEST(CloudFile, SizesThatDisagreeNameTheLine) {
  expect_error(pcd_text(kXyz, "WIDTH 3\nHEIGHT 2\nPOINTS 7\nDATA ascii\n"),
               "7 disagrees with the organised size 3 x 2", 9);
  expect_error(
      "ply\nformat ascii 1.0\nobj_info num_cols 2\nobj_info num_rows 3\nelement vertex 1\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n",
      "2 x 3 disagrees with its 1 points");
}

TEST(CloudFile, DeclaredSizesAreCheckedBeforeMemoryIsAllocated) {
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  expect_error(ply, "1000000000000 points are more than", 3);
  expect_error(pcd_text(kXyz, "WIDTH 50000000\nHEIGHT 1\nPOINTS 50000000\nDATA binary\nabc"),
               "600000000 bytes");
  expect_error(pcd_text(kXyz, "WIDTH 50000000\nHEIGHT 1\nPOINTS 50000000\nDATA ascii\n1 2 3\n"),
               "truncated");
}

TEST(CloudFile, WrongContentIsAnError) {
  expect_error("", "is empty");
  expect_error("hello", "neither a PCD nor a PLY", 1);
  expect_error(pcd_text(kXyz, "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 three\n"),
               "not one number for each field", 11);
  expect_error(pcd_text(kXyz, "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA zipped\n"), "not a kind of data");
  expect_error(pcd_text("FIELDS x y\nSIZE 4 4\nTYPE F F\n",
                        "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2\n"),
               "x, y or z is missing");
  expect_error(pcd_text("FIELDS x y z\nSIZE 4 4\nTYPE F F\n", "DATA ascii\n"), "another number");
  expect_error(
      pcd_text(kXyz, "WIDTH 1\nHEIGHT 1\nVIEWPOINT 0 0 0 0 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n"),
      "VIEWPOINT", 9);
}

/// The fuzzer's seeds and former findings, and all of their beginnings, pass in every build.
TEST(CloudFile, CorpusOfTheFuzzer) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/cloud")) {
    const Expected<std::string> bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    for (std::size_t size = 0; size <= bytes->size(); ++size) {
      EXPECT_NO_THROW(fuzz::cloud(std::string_view(*bytes).substr(0, size))) << entry.path();
    }
    ++files;
  }
  EXPECT_GT(files, 0);
}

}  // namespace
}  // namespace pcavr
