// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/recording_writer.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

#include "recording/small_recording.hpp"

namespace pcavr {
namespace {

Manifest small_manifest() { return {.camera = small_camera(), .depth_scale = 5000.0}; }

TEST(RecordingWriter, RoundTripIsLossless) {
  const TemporaryFolder folder;
  Manifest manifest = small_manifest();
  manifest.objects.push_back({.name = "box", .mesh = "objects/box.obj", .mass = 3.0});
  manifest.markers.push_back(
      {{"tag36h11", 5}, 0.08, MarkerRole::object, "box", Pose::from_translation({0, 0, 0.0625})});
  RecordingWriter writer(folder.path(), manifest);
  const Trajectory path({{milliseconds(1), Pose::from_translation({1, 2, 3})}});
  TriangleMesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  ASSERT_TRUE(
      writer.add_frame(milliseconds(1), ColorImage(16, 12), milliseconds(3), small_depth(0)));
  ASSERT_TRUE(writer.write_groundtruth(path));
  ASSERT_TRUE(writer.write_tool(path));
  ASSERT_TRUE(writer.write_wrench({{milliseconds(2), {1, 2, 3}, {4, 5, 6}}}));
  ASSERT_TRUE(writer.write_object_mesh("objects/box.obj", triangle));
  ASSERT_TRUE(writer.finish());

  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  EXPECT_EQ(recording->frames[0].depth_stamp, milliseconds(3));
  EXPECT_EQ(recording->groundtruth.poses()[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(recording->tool.size(), 1u);
  EXPECT_EQ(recording->wrench[0].force, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(recording->manifest.markers[0].object, "box");
  EXPECT_EQ(*read_file(folder.path() / "objects/box.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
}

TEST(RecordingWriter, WritesDepthOutOfRangeAsInvalid) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder.path(), small_manifest());
  DepthImage depth(16, 12, 1.0f);
  depth(0, 0) = -1.0f;
  depth(1, 0) = 13.2f;  // 65535 units of 0.2 mm are 13.107 m
  depth(2, 0) = std::numeric_limits<float>::quiet_NaN();
  depth(3, 0) = std::numeric_limits<float>::infinity();
  ASSERT_TRUE(writer.add_frame({}, ColorImage(16, 12), {}, depth));
  ASSERT_TRUE(writer.finish());
  const Recording recording = read_recording(folder.path()).value();
  const RgbdFrame frame = decode_frame(recording, 0).value();
  for (int x = 0; x < 4; ++x) EXPECT_EQ(frame.depth(x, 0), 0.0f) << x;
  EXPECT_EQ(frame.depth(4, 0), 1.0f);
}

TEST(RecordingWriter, WithoutFramesWritesNoLists) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder.path(), Manifest{});
  ASSERT_TRUE(writer.finish());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "rgb.txt"));
  EXPECT_TRUE(read_recording(folder.path()).has_value());
}

TEST(RecordingWriter, RefusesStampsThatDoNotAscend) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder.path(), small_manifest());
  const ColorImage color(16, 12);
  ASSERT_TRUE(writer.add_frame(milliseconds(5), color, milliseconds(5), small_depth(0)));
  EXPECT_THROW((void)writer.add_frame(milliseconds(5), color, milliseconds(6), small_depth(0)),
               ContractError);
}

TEST(RecordingWriter, NamesTheFileThatCanNotBeWritten) {
  const TemporaryFolder folder;
  write_text(folder.path() / "file", "");
  RecordingWriter writer(folder.path() / "file", small_manifest());
  const Expected<void> finished = writer.finish();
  ASSERT_FALSE(finished.has_value());
  EXPECT_FALSE(finished.error().file.empty());
}

}  // namespace
}  // namespace pcavr
