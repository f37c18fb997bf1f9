// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/recordings/bag_import/import_bag.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "bag_import/bag_twin.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using test::BagTwin;
using Messages = std::vector<BagTwin::Message>;

constexpr const char* kColor = "/cam/color/image_raw";
constexpr const char* kDepth = "/cam/aligned_depth_to_color/image_raw";
constexpr const char* kInfo = "/cam/color/camera_info";

/// Bags that are sound but for one thing, which a warning or an error names.
class ImportDoubts : public testing::Test {
 protected:
  Expected<BagImportReport> import(const Messages& messages) {
    BagTwin::write_mcap(folder_.path() / "a.mcap", messages);
    std::filesystem::remove_all(target_);
    std::filesystem::create_directory(target_);
    BagImportOptions options;
    options.topics.base_frame = "base_link";
    options.topics.tool_frame = "tip";
    warnings_.clear();
    const Observer observer{.progress = {}, .warn = [&](std::string_view line) {
                              warnings_ += std::string(line) + '\n';
                            }};
    return import_bag(folder_.path() / "a.mcap", target_, options, observer);
  }
  [[nodiscard]] bool warns(const std::string& part) const {
    return warnings_.find(part) != std::string::npos;
  }
  [[nodiscard]] Recording recording() const {
    const Expected<Recording> read = read_recording(target_);
    EXPECT_TRUE(read) << read.error().to_string();
    return read ? *read : Recording();
  }

  static Messages twin() { return BagTwin::messages(RosEncoder::Format::cdr); }
  static RosEncoder encoder() { return RosEncoder(RosEncoder::Format::cdr); }
  /// A static transform that arrives `seconds` after the start, with an old stamp in its header.
  static BagTwin::Message static_transform(double seconds, const char* parent, const Pose& pose) {
    RosEncoder content = encoder();
    content.number(std::uint32_t{1}).transform({BagTwin::kStart}, parent, "tip", pose);
    const Stamp log_time =
        Stamp{BagTwin::kStart} + duration_from_seconds(seconds) + std::chrono::milliseconds(2);
    return {"/tf_static", "tf2_msgs/TFMessage", log_time, content.bytes()};
  }
  static void rename(Messages& messages, const std::string& topic, const std::string& name) {
    for (BagTwin::Message& m : messages) {
      if (m.topic == topic) m.topic = name;
    }
  }
  /// Replaces all messages of the topic.
  template <typename Encode>
  static void replace(Messages& messages, const std::string& topic, Encode encode) {
    for (BagTwin::Message& m : messages) {
      if (m.topic == topic) m.payload = encode(m.log_time + std::chrono::milliseconds(-2)).bytes();
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path target_ = folder_.path() / "recording";
  std::string warnings_;
};

TEST_F(ImportDoubts, AStaticTransformHoldsUntilItIsReplaced) {
  const Pose T_flange_new = Pose::from_translation({0.0, 0.02, -0.15});
  Messages messages = twin();
  messages.insert(messages.begin() + 200, static_transform(0.5, "flange", T_flange_new));
  const auto report = import(messages);
  ASSERT_TRUE(report) << report.error().to_string();
  const Recording read = recording();
  ASSERT_EQ(read.tool.size(), std::size_t{BagTwin::kSamples});
  for (const TimedPose& tip : read.tool.poses()) {
    const bool is_new = BagTwin::seconds(tip.stamp) >= 0.5;
    const Pose expected =
        BagTwin::T_base_flange(tip.stamp) * (is_new ? T_flange_new : BagTwin::T_flange_tip());
    EXPECT_LT(translation_distance(tip.pose, expected), 1e-12) << BagTwin::seconds(tip.stamp);
  }
  EXPECT_TRUE(
      warns("frame 'tip' has a static transform that is replaced 0.500 s after the bag's "
            "start, by 53.9 mm and 0.00 deg"))
      << warnings_;
  EXPECT_FALSE(warns("flange' has")) << "it is not replaced";
}

TEST_F(ImportDoubts, AStaticTransformBeforeTheRunIsReplacedForAllOfIt) {
  Messages messages = twin();
  messages.insert(messages.begin(),
                  static_transform(-1.0, "elsewhere", Pose::from_translation({9.0, 0.0, 0.0})));
  ASSERT_TRUE(import(messages));
  const Recording read = recording();
  ASSERT_EQ(read.tool.size(), std::size_t{BagTwin::kSamples});
  for (const TimedPose& tip : read.tool.poses()) {
    EXPECT_LT(translation_distance(tip.pose, BagTwin::T_base_tip(tip.stamp)), 1e-12);
  }
  EXPECT_TRUE(warns("from parent 'elsewhere' to 'flange'")) << warnings_;
}

TEST_F(ImportDoubts, RepeatedStaticTransformsAreNoReplacement) {
  Messages messages = twin();
  for (const double t : {-3.0, 0.3, 0.6}) {
    messages.push_back(static_transform(t, "flange", BagTwin::T_flange_tip()));
  }
  ASSERT_TRUE(import(messages));
  EXPECT_EQ(warnings_, "");
  EXPECT_EQ(recording().tool.size(), std::size_t{BagTwin::kSamples});
}

TEST_F(ImportDoubts, ImagesThatAreNotReadAreNamed) {
  Messages messages = twin();
  replace(messages, kColor, [](Stamp t) {
    return encoder().image(t, "camera_optical", BagTwin::kWidth, BagTwin::kHeight, "bayer_rggb16",
                           std::string(2 * BagTwin::kWidth * BagTwin::kHeight, 'x'));
  });
  const auto report = import(messages);
  ASSERT_TRUE(report) << report.error().to_string();
  EXPECT_TRUE(warns("/cam/color/image_raw is bayer_rggb16, which is not read")) << warnings_;
  ASSERT_FALSE(report->notes.empty());
  EXPECT_NE(report->notes.back().find("is bayer_rggb16"), std::string::npos);
  // Nothing is said of a topic that is chosen for its encoding.
  ASSERT_TRUE(import(twin()));
  EXPECT_EQ(warnings_, "");
}

TEST_F(ImportDoubts, BayerImagesAreColour) {
  Messages messages = twin();
  replace(messages, kColor, [](Stamp t) {
    return encoder().image(t, "camera_optical", BagTwin::kWidth, BagTwin::kHeight, "bayer_rggb8",
                           std::string(BagTwin::kWidth * BagTwin::kHeight, 'x'));
  });
  ASSERT_TRUE(import(messages));
  EXPECT_EQ(warnings_, "");
  EXPECT_EQ(recording().frames.size(), std::size_t{BagTwin::kFrames});
}

TEST_F(ImportDoubts, DepthOfAnotherCameraInTheSameFrameIsFound) {
  const auto with_depth_camera = [&](const std::string& depth, const std::string& info, double f,
                                     double cx) {
    Messages messages = twin();
    rename(messages, kDepth, depth);
    const Stamp t = BagTwin::frame_stamp(0);
    messages.push_back(
        {info, "sensor_msgs/CameraInfo", t,
         encoder()
             .camera_info(t, "camera_optical", BagTwin::kWidth, BagTwin::kHeight, f, cx, 11.5)
             .bytes()});
    const auto report = import(messages);
    EXPECT_TRUE(report) << report.error().to_string();
    return warns("but of different cameras: " + info);
  };
  EXPECT_TRUE(with_depth_camera("/cam/depth/image_raw", "/cam/depth/camera_info", 22.0, 15.5));
  EXPECT_TRUE(warns("fx 22.0, cx 15.5) and /cam/color/camera_info (32 x 24 pixels, fx 30.0"))
      << warnings_;
  EXPECT_TRUE(with_depth_camera("/cam/depth/image_raw", "/cam/depth/camera_info", 30.0, 17.0));
  // The viewer of a camera's maker names its streams so; the other names have no folders.
  EXPECT_TRUE(with_depth_camera("/device_0/sensor_0/Depth_0/image/data",
                                "/device_0/sensor_0/Depth_0/info/camera_info", 22.0, 15.5));
  EXPECT_TRUE(with_depth_camera("/depth_image", "/depth_camera_info", 22.0, 15.5));
  // Registered depth: alike but for rounding; or the camera of other depth than that taken.
  EXPECT_FALSE(with_depth_camera("/cam/depth/image_raw", "/cam/depth/camera_info", 30.0001, 15.5));
  EXPECT_FALSE(
      with_depth_camera("/cam/depth_registered/image_raw", "/cam/depth/camera_info", 22.0, 15.5));
  EXPECT_FALSE(with_depth_camera(kDepth, "/cam/depth/camera_info", 22.0, 15.5));
  EXPECT_EQ(warnings_, "");
}

TEST_F(ImportDoubts, TheCameraIsThatOfTheRegionOfInterest) {
  Messages messages = twin();
  replace(messages, kInfo, [](Stamp t) {
    return encoder().camera_info(t, "camera_optical", 2 * BagTwin::kWidth, 2 * BagTwin::kHeight,
                                 30.0, 31.5, 23.5,
                                 {1, 1, 16, 12, BagTwin::kHeight, BagTwin::kWidth});
  });
  const auto report = import(messages);
  ASSERT_TRUE(report) << report.error().to_string();
  const Recording read = recording();
  ASSERT_TRUE(read.manifest.camera);
  EXPECT_EQ(read.manifest.camera->width, BagTwin::kWidth);
  EXPECT_EQ(read.manifest.camera->fx, 30.0);
  EXPECT_EQ(read.manifest.camera->cx, 15.5);
  EXPECT_EQ(read.manifest.camera->cy, 11.5);
}

/// A recording that reading would refuse is not written.
TEST_F(ImportDoubts, StampsOfTwoClocksInOneTopicAreRefused) {
  Messages messages = twin();
  const auto first = std::find_if(messages.begin(), messages.end(),
                                  [](const auto& m) { return m.topic == "/ft"; });
  first->payload = encoder()
                       .header(Stamp{1'000'000'000}, "flange")
                       .vector({0.0, 0.0, 0.0})
                       .vector({0.0, 0.0, 0.0})
                       .bytes();
  const auto report = import(messages);
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().to_string().find("a.mcap: /ft: goes from 1.000000 to 1700000000.99"),
            std::string::npos)
      << report.error().to_string();
}

}  // namespace
}  // namespace pcavr
