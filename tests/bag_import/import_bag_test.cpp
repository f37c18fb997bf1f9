// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/import_bag.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "bag_import/bag_twin.hpp"
#include "support/file_tree.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using test::BagTwin;

const ImportedStream& stream_of(const BagImportReport& report, const std::string& file) {
  return *std::find_if(report.streams.begin(), report.streams.end(),
                       [&](const ImportedStream& stream) { return stream.file == file; });
}

class ImportBag : public testing::Test {
 protected:
  std::filesystem::path bag_file(RosEncoder::Format format) const {
    const bool is_ros1 = format == RosEncoder::Format::ros1;
    const std::filesystem::path file = folder_.path() / (is_ros1 ? "twin.bag" : "twin.mcap");
    const std::vector<BagTwin::Message> messages = BagTwin::messages(format);
    if (is_ros1)
      BagTwin::write_ros1(file, messages);
    else
      BagTwin::write_mcap(file, messages);
    return file;
  }
  static BagImportOptions by_frame() {
    BagImportOptions options;
    options.topics.base_frame = "base_link";
    options.topics.tool_frame = "/tip";
    return options;
  }
  Expected<BagImportReport> import(const std::filesystem::path& bag,
                                   const BagImportOptions& options) {
    const std::filesystem::path target = folder_.path() / "recording";
    std::filesystem::remove_all(target);
    std::filesystem::create_directory(target);
    return import_bag(bag, target, options);
  }
  std::string error_of(const BagImportOptions& options) {
    const auto report = import(bag_file(RosEncoder::Format::cdr), options);
    return report ? std::string() : report.error().to_string();
  }
  Expected<Recording> recording() const { return read_recording(folder_.path() / "recording"); }

  TemporaryFolder folder_;
};

class ImportBagTwin : public ImportBag, public testing::WithParamInterface<RosEncoder::Format> {};

/// Forces, poses and images of the bag are those that it was made of.
TEST_P(ImportBagTwin, IsTheOriginalRecording) {
  const auto report = import(bag_file(GetParam()), by_frame());
  ASSERT_TRUE(report) << report.error().to_string();
  const Expected<Recording> read = recording();
  ASSERT_TRUE(read) << read.error().to_string();
  ASSERT_EQ(read->tool.size(), std::size_t{BagTwin::kSamples});
  for (const TimedPose& tip : read->tool.poses()) {
    EXPECT_LT(translation_distance(tip.pose, BagTwin::T_base_tip(tip.stamp)), 1e-12);
    EXPECT_LT(rotation_distance(tip.pose, BagTwin::T_base_tip(tip.stamp)), 1e-7);
  }
  ASSERT_EQ(read->wrench.size(), std::size_t{BagTwin::kSamples});
  for (const WrenchSample& sample : read->wrench) {
    EXPECT_LT((sample.force - BagTwin::force(sample.stamp)).norm(), 1e-12);
    EXPECT_LT((sample.torque - BagTwin::torque(sample.stamp)).norm(), 1e-12);
  }
  EXPECT_EQ(read->joints.size(), std::size_t{BagTwin::kSamples});
  const auto box = read_trajectory(folder_.path() / "recording/tracked/objects/box/tracked.txt");
  ASSERT_TRUE(box);
  ASSERT_EQ(box->size(), std::size_t{BagTwin::kSamples});
  for (const TimedPose& pose : box->poses()) {
    EXPECT_LT(translation_distance(pose.pose, BagTwin::T_base_box(pose.stamp)), 1e-12);
  }
  EXPECT_EQ(stream_of(*report, "wrench.csv").reordered, 2U);  // the swap, and the repetition
  EXPECT_EQ(stream_of(*report, "wrench.csv").duplicates, 1U);
  EXPECT_NEAR(stream_of(*report, "wrench.csv").delay.value_or(0.0), 0.002, 1e-9);
}

TEST_P(ImportBagTwin, HasTheOriginalImages) {
  ASSERT_TRUE(import(bag_file(GetParam()), by_frame()));
  const Expected<Recording> read = recording();
  ASSERT_TRUE(read) << read.error().to_string();
  ASSERT_TRUE(read->manifest.camera);
  EXPECT_EQ(read->manifest.camera->fx, 30.0);
  EXPECT_EQ(read->manifest.depth_scale, 1000.0);
  ASSERT_EQ(read->frames.size(), std::size_t{BagTwin::kFrames});
  ASSERT_EQ(read->groundtruth.size(), std::size_t{BagTwin::kFrames});
  EXPECT_LT(translation_distance(read->groundtruth.poses()[0].pose, BagTwin::T_base_camera()),
            1e-12);
  FrameReader reader(*read);
  for (int i = 0; i < BagTwin::kFrames; ++i) {
    const auto frame = reader.next();
    ASSERT_TRUE(frame && *frame);
    EXPECT_EQ((*frame)->depth_stamp, BagTwin::frame_stamp(i));
    for (int y = 0; y < BagTwin::kHeight; ++y) {
      for (int x = 0; x < BagTwin::kWidth; ++x) {
        ASSERT_NEAR((*frame)->depth(x, y), 1e-3 * BagTwin::depth(i, x, y), 1e-6);
        ASSERT_NEAR((*frame)->color(x, y).r, BagTwin::color(x, y).r, 12);  // JPEG
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ImportBagTwin,
                         testing::Values(RosEncoder::Format::ros1, RosEncoder::Format::cdr));

/// A rig's recording.yaml that names calibrations: what they found is in the recording.
class ImportOfACalibratedRig : public ImportBag {
 protected:
  Expected<Recording> imported(const std::string& depth_scale, BagImportOptions options) {
    const auto write = [&](const char* name, const std::string& text) {
      EXPECT_TRUE(write_file(folder_.path() / name, text));
    };
    std::string rows;
    for (int row = 0; row < 6; ++row) {
      rows += "      - [";
      for (int column = 0; column < 6; ++column) {
        rows += std::string(column > 0 ? ", " : "") + (row == column ? "4e-6" : "1e-7");
      }
      rows += "]\n";
    }
    write("tags.yaml",
          "format: pcavr-calibration/1\nkind: tags\nmarkers:\n"
          "  - {family: tag36h11, id: 0, size: 0.15, role: base,\n"
          "     pose: {t: [0.5, 0.3, 0], q: [0, 0, 0, 1]}}\n"
          "accuracy:\n  - tag: tag36h11:0\n    covariance:\n" +
              rows);
    write("force.yaml",
          "format: pcavr-calibration/1\nkind: force\nrotation_std: [0.001, 0.003, 0.002]\n");
    write("depth.yaml", "format: pcavr-calibration/1\nkind: depth\ndepth_scale: " + depth_scale +
                            "\ndepth_offset: 0.0125\n");
    write("rig.yaml",
          "format: pcavr-recording/1\ncamera: {width: 8, height: 6, fx: 9, fy: 9, cx: 4, cy: 3, "
          "depth_scale: 1000}\ncalibration: [tags.yaml, force.yaml, depth.yaml]\n");
    options.manifest = folder_.path() / "rig.yaml";
    const auto report = import(bag_file(RosEncoder::Format::ros1), options);
    if (!report) return report.error();
    return recording();
  }
};

TEST_F(ImportOfACalibratedRig, KeepsCovariancesStdsAndTheDepthsCorrection) {
  const auto read = imported("980", by_frame());
  ASSERT_TRUE(read) << read.error().to_string();
  ASSERT_EQ(read->manifest.markers.size(), 1U);
  EXPECT_EQ(read->manifest.markers[0].covariance(2, 2), 4e-6);
  EXPECT_EQ(read->manifest.markers[0].covariance(0, 5), 1e-7);
  EXPECT_EQ(read->manifest.force_direction_std, 0.003);
  EXPECT_EQ(read->manifest.depth_scale, 980.0);
  EXPECT_EQ(read->manifest.depth_offset, 0.0125);
}

TEST_F(ImportOfACalibratedRig, LeavesOutTheDepthsCorrectionOfOtherUnits) {
  for (const bool is_stated : {false, true}) {
    BagImportOptions options = by_frame();
    if (is_stated) options.raw_depth_scale = 1000.0;
    const auto read = imported(is_stated ? "980" : "4900", options);
    ASSERT_TRUE(read) << read.error().to_string();
    EXPECT_EQ(read->manifest.depth_scale, 1000.0);
    EXPECT_EQ(read->manifest.depth_offset, 0.0);
  }
}

TEST_F(ImportBag, WithoutTfForcesAreTakenAsTheyAreWithAWarning) {
  std::vector<BagTwin::Message> messages = BagTwin::messages(RosEncoder::Format::ros1);
  std::erase_if(messages,
                [](const auto& m) { return m.topic != "/ft" && m.topic != "/mocap/box"; });
  BagTwin::write_ros1(folder_.path() / "a.bag", messages);
  const std::filesystem::path target = folder_.path() / "recording";
  std::filesystem::create_directory(target);
  std::vector<std::string> warnings;
  const Observer observer{.progress = {},
                          .warn = [&](std::string_view line) { warnings.emplace_back(line); }};
  const auto report = import_bag(folder_.path() / "a.bag", target, {}, observer);
  ASSERT_TRUE(report) << report.error().to_string();
  const bool names_option = std::any_of(warnings.begin(), warnings.end(), [](const auto& line) {
    return line.find("--wrench-frame") != line.npos;
  });
  EXPECT_TRUE(names_option);
}

TEST_F(ImportBag, DepthAloneIsImportedWithGreyFrames) {
  BagImportOptions options = by_frame();
  options.topics.color_topic = "none";
  ASSERT_TRUE(import(bag_file(RosEncoder::Format::cdr), options));
  const Expected<Recording> read = recording();
  ASSERT_TRUE(read) << read.error().to_string();
  FrameReader reader(*read);
  const auto frame = reader.next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_NEAR((*frame)->color(3, 3).r, 128, 2);
  EXPECT_NEAR((*frame)->depth(3, 3), 1e-3 * BagTwin::depth(0, 3, 3), 1e-6);
}

/// Imports the twin without the topics whose names contain one of `left_out`.
class ImportBagOfColour : public ImportBag {
 protected:
  Expected<BagImportReport> import_without(const std::vector<std::string>& left_out,
                                           BagImportOptions options = by_frame()) {
    std::vector<BagTwin::Message> messages = BagTwin::messages(RosEncoder::Format::cdr);
    std::erase_if(messages, [&](const BagTwin::Message& message) {
      return std::any_of(left_out.begin(), left_out.end(), [&](const std::string& part) {
        return message.topic.find(part) != std::string::npos;
      });
    });
    BagTwin::write_mcap(folder_.path() / "colour.mcap", messages);
    return import(folder_.path() / "colour.mcap", options);
  }
};

TEST_F(ImportBagOfColour, AloneHasFramesWithoutDepth) {
  const auto report = import_without({"depth"});
  ASSERT_TRUE(report) << report.error().to_string();
  EXPECT_EQ(stream_of(*report, "rgb").rows, std::size_t{BagTwin::kFrames});
  const Expected<Recording> read = recording();
  ASSERT_TRUE(read) << read.error().to_string();
  EXPECT_FALSE(read->has_depth);
  EXPECT_EQ(read->groundtruth.size(), std::size_t{BagTwin::kFrames});
  ASSERT_EQ(read->frames.size(), std::size_t{BagTwin::kFrames});
  FrameReader reader(*read);
  const auto frame = reader.next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_NEAR((*frame)->color(9, 9).r, BagTwin::color(9, 9).r, 12);
}

TEST_F(ImportBagOfColour, WithoutCameraInfoIsLeftOutWithANoteUnlessItIsNamed) {
  const auto report = import_without({"depth", "camera_info"});
  ASSERT_TRUE(report) << report.error().to_string();
  ASSERT_EQ(report->notes.size(), 1U);
  EXPECT_EQ(report->notes[0],
            "/cam/color/image_raw has no camera info; give --camera with a calibration file");
  EXPECT_TRUE(recording()->frames.empty());
  BagImportOptions named = by_frame();
  named.topics.color_topic = "/cam/color/image_raw";
  const auto refused = import_without({"depth", "camera_info"}, named);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("has no camera info for /cam/color"), std::string::npos);
}

TEST_F(ImportBag, TheTipIsPlacedInTheToolsFrame) {
  BagImportOptions options = by_frame();
  options.topics.tool_frame = "flange";
  options.p_tool_tip = BagTwin::T_flange_tip().translation();
  ASSERT_TRUE(import(bag_file(RosEncoder::Format::cdr), options));
  const Expected<Recording> read = recording();
  ASSERT_TRUE(read) << read.error().to_string();
  for (const TimedPose& tip : read->tool.poses()) {
    EXPECT_LT(translation_distance(tip.pose, BagTwin::T_base_tip(tip.stamp)), 1e-12);
  }
}

TEST_F(ImportBag, BadOptionsAreOneLine) {
  const auto with = [&](auto change) {
    BagImportOptions options;
    change(options.topics);
    return error_of(options);
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != text.npos;
  };
  EXPECT_TRUE(has(with([](auto& t) { t.wrench_topic = "/fft"; }),
                  "--wrench-topic: topic '/fft' is not in the bag; near matches: /ft"));
  EXPECT_TRUE(has(with([](auto& t) { t.tool_topic = "ft"; }), "it takes PoseStamped"));
  EXPECT_TRUE(has(with([](auto& t) { t.depth_topic = "/cam/color/image_raw"; }), "(bgr8)"));
  EXPECT_TRUE(has(with([](auto& t) { t.tool_frame = "tipp"; }), "near matches: tip"));
  EXPECT_TRUE(has(with([](auto& t) {
                    t.base_frame = "box";
                    t.tool_frame = "tip";
                  }),
                  "--base-frame"));
  EXPECT_TRUE(has(with([](auto& t) {
                    t.objects = {{"a/b", "/mocap/box"}};
                  }),
                  "can't be an object's name"));
  EXPECT_TRUE(has(with([](auto& t) {
                    t.tool_frame = "a";
                    t.tool_topic = "b";
                  }),
                  "can't be combined"));
}

TEST_F(ImportBag, FramesThatTfDoesNotConnectAreAnError) {
  std::vector<BagTwin::Message> messages = BagTwin::messages(RosEncoder::Format::ros1);
  RosEncoder island(RosEncoder::Format::ros1);
  island.number(std::uint32_t{1}).transform({BagTwin::kStart}, "island", "palm", Pose());
  messages.push_back({"/tf", "tf2_msgs/TFMessage", {BagTwin::kStart}, island.bytes()});
  BagTwin::write_ros1(folder_.path() / "b.bag", messages);
  BagImportOptions options = by_frame();
  options.topics.tool_frame = "palm";
  const auto report = import(folder_.path() / "b.bag", options);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().message, "no TF chain from 'base_link' to 'palm'");
}

TEST_F(ImportBag, AnEmptyBagIsAnError) {
  const Expected<McapWriter> writer = McapWriter::create(folder_.path() / "empty.mcap");
  ASSERT_TRUE(writer);
  const auto report = import(folder_.path() / "empty.mcap", {});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().message, "has no messages");
}

}  // namespace
}  // namespace pcavr
