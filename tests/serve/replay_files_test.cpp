// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/base64.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/serve/replay_content.hpp"
#include "pcavr/serve/replay_log.hpp"
#include "pcavr/serve/replay_page.hpp"
#include "pcavr/serve/scene_content.hpp"

#include "pipeline/small_replay.hpp"
#include "serve/decoded_content.hpp"
#include "support/meshes.hpp"
#include "support/read_bag.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

constexpr char kBefore[] = "<!-- SPDX-FileCopyrightText: The pcavr authors --><script>";
constexpr char kAfter[] = "</script>";

/// A small replay with images, and a page to put it into.
class ReplayPageTest : public testing::Test {
 protected:
  void SetUp() override {
    write_small_replay(folder_.path());
    recording_ = *read_recording(folder_.path() / "recording");
    const SceneManifest manifest = *read_scene_manifest(folder_.path() / "scene");
    ReplayOptions options;
    options.tracked = folder_.path() / "tracked";
    const Replay replay = *replay_recording(recording_, manifest, options);
    scene_.emplace(*SceneContent::create(manifest));
    replay_.emplace(*ReplayContent::create(recording_, manifest, replay));
    ASSERT_TRUE(write_file(page_, kBefore + std::string("CARRIED_FILES") + kAfter));
  }

  Expected<ReplayPage> write(const ReplayPageOptions& options = {}) {
    return write_replay_page(file_, page_, *scene_, *replay_, "a scene", "1.2.3", options);
  }

  /// The files that the written page carries.
  nlohmann::json carried() {
    const Expected<std::string> html = read_file(file_);
    if (!html) return {};
    EXPECT_TRUE(html->starts_with(kBefore) && html->ends_with(kAfter));
    const std::size_t begin = std::string_view(kBefore).size();
    const std::size_t length = html->size() - begin - std::string_view(kAfter).size();
    return nlohmann::json::parse(html->substr(begin, length), nullptr, false);
  }

  const TemporaryFolder folder_;
  const fs::path page_ = folder_.path() / "page.html";
  const fs::path file_ = folder_.path() / "replay.html";
  Recording recording_;
  std::optional<SceneContent> scene_;
  std::optional<ReplayContent> replay_;
};

/// The JSON of a carried file, as the page unpacks it.
nlohmann::json unpacked(const nlohmann::json& files, const ContentSource& source,
                        const std::string& path) {
  EXPECT_EQ(files[path]["base64"], base64((**source.find(path)).body)) << path;
  return json_of(source, path);
}

TEST_F(ReplayPageTest, CarriesWhatThePageRequests) {
  const Expected<ReplayPage> page = write();
  ASSERT_TRUE(page) << page.error().to_string();
  EXPECT_EQ(page->bytes, fs::file_size(file_));
  EXPECT_EQ(page->images, 5U);
  EXPECT_EQ(page->images_recorded, 5U);
  EXPECT_GT(page->triangles, 0U);
  const nlohmann::json files = carried();
  ASSERT_TRUE(files.is_object());
  for (const char* path : {"/api/session", "/api/scene.json", "/api/replay.json", "/api/replay.bin",
                           "/scene/objects/box.glb", "/api/frames/4.jpg"}) {
    EXPECT_TRUE(files.contains(path)) << path;
  }
  const nlohmann::json replay = unpacked(files, *replay_, "/api/replay.json");
  EXPECT_EQ(replay["frames"]["t"].size(), 5U);
  EXPECT_EQ(files["/api/frames/4.jpg"]["type"], "image/jpeg");
  EXPECT_EQ(files["/api/frames/4.jpg"]["gzip"], false);
}

TEST_F(ReplayPageTest, HasAsManyImagesAsHaveRoom) {
  const std::size_t whole = write()->bytes;
  const std::size_t image = carried()["/api/frames/2.jpg"]["base64"].get<std::string>().size();
  ReplayPageOptions options;
  options.replace = true;
  options.max_bytes = whole - 2 * image;
  const Expected<ReplayPage> page = write(options);
  ASSERT_TRUE(page) << page.error().to_string();
  EXPECT_LE(fs::file_size(file_), options.max_bytes);
  EXPECT_GE(page->images, 1U);
  EXPECT_LE(page->images, 3U);
  const nlohmann::json files = carried();
  EXPECT_TRUE(files.contains("/api/frames/0.jpg"));
  EXPECT_FALSE(files.contains("/api/frames/" + std::to_string(page->images) + ".jpg"));
}

TEST_F(ReplayPageTest, RefusesWhatItCannotWrite) {
  ReplayPageOptions options;
  options.max_bytes = 500;
  const Expected<ReplayPage> small = write(options);
  ASSERT_FALSE(small);
  EXPECT_NE(small.error().message.find("MB"), std::string::npos);
  EXPECT_FALSE(fs::exists(file_));
  ASSERT_TRUE(write_file(file_, "<html>someone's page</html>"));
  EXPECT_FALSE(write());
  options = {};
  options.replace = true;
  EXPECT_FALSE(write(options)) << "not a page of pcavr";
  EXPECT_EQ(*read_file(file_), "<html>someone's page</html>");
  EXPECT_FALSE(check_replay_page(folder_.path() / "replay.htm", false));
  ASSERT_TRUE(write_file(page_, "<html></html>"));
  fs::remove(file_);
  EXPECT_FALSE(write());
}

/// Two seconds of a body that slides along x, with what a run has of it.
Replay a_pushed_body() {
  Replay replay;
  replay.objects.push_back({"box 1", true, {}});
  TeleopRun run;
  run.shown.resize(1);
  for (int i = 0; i < 2000; ++i) {
    const double t = 100.0 + 0.001 * i;
    run.shown[0].push_back({t, Pose::from_translation({0.1 * (t - 100.0), 0.0, 0.0})});
    run.forces.push_back({t, 0, 5.0, 4.0});
  }
  for (int i = 0; i < 20; ++i) {
    replay.objects[0].tracked.push_back(
        {100.0 + 0.1 * i, Pose::from_translation({0.01 * i, 0.0, 0.0}), 0.001, 0.01});
  }
  run.phases = {{100.0, 0, MotionPhase::free, MotionPhase::free},
                {101.0, 0, MotionPhase::sliding, MotionPhase::static_contact}};
  run.corrections = {{101.5, 0, CorrectionCase::phases_differ, "position", 31, true}};
  run.parameters.resize(1);
  replay.teleop = run;
  return replay;
}

class ReplayLogTest : public testing::Test {
 protected:
  void SetUp() override {
    write_small_recording(folder_.path() / "recording");
    recording_ = *read_recording(folder_.path() / "recording");
    scene_.scan_base = a_box({1.0F, 1.0F, 0.1F});
    scene_.bodies_object = {a_box({0.1F, 0.1F, 0.1F})};
    scene_.points_base = {{0.0F, 0.0F, 0.0F}};
  }
  const TemporaryFolder folder_;
  const fs::path file_ = folder_.path() / "run.mcap";
  Recording recording_;
  ViewerScene scene_;
};

TEST_F(ReplayLogTest, HasTheRecordedJointsAndTheArmsDescription) {
  scene_.urdf = "<robot name='arm'/>";
  scene_.joints = {"shoulder", "elbow"};
  JointLog log;
  log.joints = {"1", "2"};
  log.position = Eigen::MatrixXd(1000, 2);
  for (int i = 0; i < 1000; ++i) {
    log.t.push_back(0.001 * i);
    log.stamps.push_back(Stamp::from_seconds(100.0 + log.t.back()));
    log.position.row(i) << 0.001 * i, -1.0;
  }
  const Expected<std::uint64_t> written =
      write_replay_log(file_, recording_, a_pushed_body(), scene_, {.rate = 100.0}, log);
  ASSERT_TRUE(written) << written.error().to_string();
  const test::ReadBag bag = test::read_all(open_bag(file_));
  std::vector<RosJointState> states;
  int descriptions = 0;
  for (const test::ReadMessage& message : bag.messages) {
    if (message.topic == "/robot_description") ++descriptions;
    if (message.topic != "/joint_states") continue;
    const auto state =
        decode_ros_message({.name = "",
                            .type = "sensor_msgs/msg/JointState",
                            .encoding = "cdr",
                            .schema_encoding = {},
                            .schema = {}},
                           std::span(reinterpret_cast<const std::uint8_t*>(message.payload.data()),
                                     message.payload.size()));
    ASSERT_TRUE(state) << state.error().to_string();
    states.push_back(std::get<RosJointState>(*state));
  }
  EXPECT_EQ(descriptions, 1);
  ASSERT_EQ(states.size(), 100U);
  EXPECT_EQ(states[50].names, scene_.joints);
  EXPECT_NEAR(states[50].position[0], 0.5, 1e-9);
  EXPECT_EQ(states[50].position[1], -1.0);
}

TEST_F(ReplayLogTest, HasTheChannelsOfALiveSiteInTheOrderOfTime) {
  const Expected<std::uint64_t> written =
      write_replay_log(file_, recording_, a_pushed_body(), scene_);
  ASSERT_TRUE(written) << written.error().to_string();
  const test::ReadBag bag = test::read_all(open_bag(file_));
  EXPECT_EQ(bag.error, "");
  EXPECT_TRUE(bag.warnings.empty());
  EXPECT_EQ(bag.messages.size(), *written);
  EXPECT_TRUE(std::is_sorted(bag.messages.begin(), bag.messages.end(),
                             [](auto& a, auto& b) { return a.log_time < b.log_time; }));
  std::map<std::string, int> count;
  for (const test::ReadMessage& message : bag.messages) ++count[message.topic];
  const std::map<std::string, int> expected = {{"/scene", 1},
                                               {"/points", 1},
                                               {"/parameters", 1},
                                               {"/camera/image/compressed", 5},
                                               {"/camera/camera_info", 5},
                                               {"/tracked/box_1", 20},
                                               {"/predicted/box_1", 200},
                                               {"/push_force/box_1", 200},
                                               {"/tf", 220},
                                               {"/phases", 2},
                                               {"/measured_phases", 2},
                                               {"/corrections", 1}};
  EXPECT_EQ(count, expected);
}

TEST_F(ReplayLogTest, HasTheCameraAndItsImagesAsRecorded) {
  std::size_t images = 0;
  for (const FrameFiles& frame : recording_.frames) {  // each another
    std::ofstream(recording_.folder / frame.color_path, std::ios::app) << images++;
  }
  images = 0;
  ASSERT_TRUE(write_replay_log(file_, recording_, a_pushed_body(), scene_));
  const test::ReadBag bag = test::read_all(open_bag(file_));
  for (const test::ReadMessage& message : bag.messages) {
    const auto topic = std::ranges::find(bag.topics, message.topic, &BagTopic::name);
    ASSERT_NE(topic, bag.topics.end());
    const auto decoded = decode_ros_message(*topic, test::bytes_of(message.payload));
    if (message.topic == "/camera/camera_info") {
      ASSERT_TRUE(decoded) << decoded.error().to_string();
      const auto& info = std::get<RosCameraInfo>(*decoded);
      const CameraModel& camera = *recording_.manifest.camera;
      EXPECT_EQ(info.width, camera.width);
      EXPECT_EQ(info.height, camera.height);
      EXPECT_EQ(info.intrinsics(0, 0), camera.fx);
      EXPECT_EQ(info.intrinsics(1, 2), camera.cy);
      EXPECT_EQ(info.projection(1, 1), camera.fy);
      EXPECT_EQ(info.distortion_model, "plumb_bob");
    }
    if (message.topic != "/camera/image/compressed") continue;
    ASSERT_TRUE(decoded) << decoded.error().to_string();
    const auto& image = std::get<RosCompressedImage>(*decoded);
    const FrameFiles& frame = recording_.frames.at(images++);
    EXPECT_EQ(std::string(image.data.begin(), image.data.end()),
              *read_file(recording_.folder / frame.color_path));
  }
  EXPECT_EQ(images, recording_.frames.size());
}

TEST_F(ReplayLogTest, IsTheSameAtEachRunAndReplacesNothingElse) {
  ReplayLogOptions options;
  options.replace = true;
  ASSERT_TRUE(write_replay_log(file_, recording_, a_pushed_body(), scene_, options));
  const std::string first = *read_file(file_);
  EXPECT_FALSE(write_replay_log(file_, recording_, a_pushed_body(), scene_));
  ASSERT_TRUE(write_replay_log(file_, recording_, a_pushed_body(), scene_, options));
  EXPECT_EQ(*read_file(file_), first);
  ASSERT_TRUE(write_file(folder_.path() / "other.mcap", "not an MCAP file"));
  EXPECT_FALSE(write_replay_log(folder_.path() / "other.mcap", recording_, a_pushed_body(), scene_,
                                options));
}

}  // namespace
}  // namespace pcavr
