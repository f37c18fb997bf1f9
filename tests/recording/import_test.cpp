// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/import.hpp"

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

#include "recording/small_recording.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

/// Frames 0, 1 and 3 of a 7-Scenes sequence; one pixel was not measured, one pose was lost, and
/// frame 3 has no depth image.
void write_seven_scenes(const fs::path& folder) {
  RawDepthImage depth(16, 12, std::uint16_t{1500});
  depth(2, 1) = 65535;
  const std::string jpeg = encode_color(ColorImage(16, 12)).value();
  for (const char* number : {"000000", "000001", "000003"}) {
    const std::string stem = std::string("frame-") + number;
    write_text(folder / (stem + ".color.jpg"), jpeg);
    if (stem != "frame-000003") write_text(folder / (stem + ".depth.png"), encode_depth(depth));
  }
  write_text(folder / "frame-000000.pose.txt", "1 0 0 0.5\n0 1 0 0.25\n0 0 1 2\n0 0 0 1\n");
  write_text(folder / "frame-000001.pose.txt",
             "nan nan nan nan\nnan nan nan nan\nnan nan nan nan\nnan nan nan nan\n");
}

TEST(Import, ConvertsSevenScenesToARecording) {
  const TemporaryFolder source;
  const TemporaryFolder target;
  write_seven_scenes(source.path());
  const Expected<ImportReport> report = import_recording(source.path(), target.path());
  ASSERT_TRUE(report.has_value()) << report.error().to_string();
  EXPECT_EQ(report->format, ImportFormat::seven_scenes);
  EXPECT_EQ(report->frames, 2u);
  EXPECT_EQ(report->left_out, 1u);
  EXPECT_EQ(report->poses, 1u);
  EXPECT_EQ(report->poses_left_out, 1u);

  const Recording recording = read_recording(target.path()).value();
  EXPECT_EQ(recording.manifest.camera->fx, 585.0 * 16 / 640);
  EXPECT_EQ(recording.manifest.camera->cx, 8.0);
  EXPECT_EQ(recording.manifest.camera->width, 16);
  EXPECT_EQ(recording.frames[1].color_stamp, Stamp{33'333'333});
  EXPECT_EQ(recording.groundtruth.poses()[0].pose.translation(), Eigen::Vector3d(0.5, 0.25, 2));
  const RgbdFrame frame = decode_frame(recording, 0).value();
  EXPECT_EQ(frame.depth(2, 1), 0.0f);
  EXPECT_FLOAT_EQ(frame.depth(3, 1), 1.5f);
}

TEST(Import, UsesTheIntrinsicsOfTheFolder) {
  const TemporaryFolder source;
  const TemporaryFolder target;
  write_seven_scenes(source.path());
  write_text(source.path() / "camera-intrinsics.txt", "15 0 8\n0 16 6\n0 0 1\n");
  ASSERT_TRUE(import_recording(source.path(), target.path()).has_value());
  const Recording recording = read_recording(target.path()).value();
  EXPECT_EQ(recording.manifest.camera->fy, 16.0);
  EXPECT_EQ(recording.manifest.camera->cx, 8.0);
}

TEST(Import, RefusesIntrinsicsThatAreImpossibleForTheImages) {
  const TemporaryFolder source;
  const TemporaryFolder target;
  write_seven_scenes(source.path());
  write_text(source.path() / "camera-intrinsics.txt", "1e-300 0 8\n0 16 6\n0 0 1\n");
  const auto report = import_recording(source.path(), target.path());
  ASSERT_FALSE(report.has_value());
  EXPECT_NE(report.error().to_string().find("camera-intrinsics.txt"), std::string::npos);
  EXPECT_NE(report.error().message.find("focal length"), std::string::npos);
}

TEST(Import, TakesEveryNthFrameFromTheFirstSelected) {
  const TemporaryFolder source;
  const TemporaryFolder target;
  write_seven_scenes(source.path());
  const auto report = import_recording(source.path(), target.path(), {.stride = 2, .first = 1});
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->frames, 1u);
  EXPECT_FALSE(import_recording(source.path(), target.path(), {.first = 9}).has_value());
}

/// A TUM RGB-D folder is a recording without its manifest.
void make_tum(const SmallRecording& recording) {
  fs::remove(recording.path() / "recording.yaml");
  recording.write("groundtruth.txt", "# by motion capture\n0.9 0 0 0 0 0 0 1\n1.2 0 0 1 0 0 0 1\n");
}

TEST(Import, ConvertsTumToARecordingWithTheGivenCamera) {
  const SmallRecording source;
  const TemporaryFolder target;
  make_tum(source);
  const auto report = import_recording(source.path(), target.path(), {.camera = small_camera()});
  ASSERT_TRUE(report.has_value()) << report.error().to_string();
  EXPECT_EQ(report->format, ImportFormat::tum_rgbd);
  EXPECT_EQ(report->frames, 3u);
  EXPECT_EQ(report->poses, 2u);
  const Recording recording = read_recording(target.path()).value();
  EXPECT_EQ(recording.manifest.depth_scale, 5000.0);
  EXPECT_NEAR(decode_frame(recording, 1).value().depth(5, 5), small_depth(1)(5, 5), 1e-6);
}

TEST(Import, TakesTheDepthScaleUnderWhichReadingsAreInTheSensorsRange) {
  const SmallRecording source;
  make_tum(source);
  const float reading = small_depth(1)(5, 5);  // as written, at 5000 units in a metre
  ImportOptions options{.camera = small_camera(), .camera_depth_scale = 1000.0};
  const auto scale_of = [&](double min_depth, double max_depth) {
    const TemporaryFolder target;
    options.depth_noise = DepthNoise(min_depth, max_depth);
    return import_recording(source.path(), target.path(), options).value().depth_scale;
  };
  const ImportedDepthScale near = scale_of(0.5 * reading, 2.0 * reading);
  EXPECT_EQ(near.used, 5000.0);
  EXPECT_EQ(near.other, 1000.0);
  EXPECT_GT(near.share_in_range.value(), 2.0 * near.other_share_in_range.value());
  EXPECT_EQ(scale_of(2.5 * reading, 10.0 * reading).used, 1000.0);
  EXPECT_EQ(scale_of(0.5 * reading, 10.0 * reading).used, 1000.0) << "both are possible";
  options.depth_scale = 2000.0;
  EXPECT_EQ(scale_of(0.5 * reading, 2.0 * reading).used, 2000.0);
}

TEST(Import, TakesMillimetresWhereNoScaleIsStatedAndTheLayoutsOwnIsOutOfRange) {
  const SmallRecording source;
  make_tum(source);
  const float reading = small_depth(1)(5, 5);  // as written, at 5000 units in a metre
  ImportOptions options{.camera = small_camera()};
  const auto scale_of = [&](double min_depth, double max_depth) {
    const TemporaryFolder target;
    options.depth_noise = DepthNoise(min_depth, max_depth);
    return import_recording(source.path(), target.path(), options).value().depth_scale;
  };
  const ImportedDepthScale millimetres = scale_of(2.5 * reading, 10.0 * reading);
  EXPECT_EQ(millimetres.used, 1000.0);
  EXPECT_EQ(millimetres.other, 5000.0);
  EXPECT_GT(millimetres.share_in_range.value(), 2.0 * millimetres.other_share_in_range.value());
  const ImportedDepthScale both = scale_of(0.5 * reading, 10.0 * reading);
  EXPECT_EQ(both.used, 5000.0);
  EXPECT_FALSE(both.other);
}

TEST(Import, RequiresACameraForTum) {
  const SmallRecording source;
  const TemporaryFolder target;
  make_tum(source);
  const auto report = import_recording(source.path(), target.path());
  ASSERT_FALSE(report.has_value());
  EXPECT_NE(report.error().hint.find("--camera"), std::string::npos);
}

TEST(Import, RefusesUnknownFolders) {
  const TemporaryFolder folder;
  const SmallRecording recording;
  EXPECT_FALSE(import_recording(folder.path(), folder.path()).has_value());
  EXPECT_FALSE(import_recording(folder.path() / "absent", folder.path()).has_value());
  EXPECT_FALSE(import_recording(recording.path(), folder.path()).has_value());
}

TEST(Import, ReadsTheSharedSequence) {
  PCAVR_NEEDS_SHARED_DATA("real/seven_scenes");
  const TemporaryFolder target;
  const auto report =
      import_recording(shared_data("real/seven_scenes"), target.path(), {.stride = 30});
  ASSERT_TRUE(report.has_value()) << report.error().to_string();
  EXPECT_EQ(report->frames, 5u);
  EXPECT_EQ(report->poses, 5u);
  const Recording recording = read_recording(target.path()).value();
  EXPECT_TRUE(decode_frame(recording, 4).has_value());
}

}  // namespace
}  // namespace pcavr
