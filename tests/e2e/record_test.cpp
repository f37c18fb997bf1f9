// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// pcavr record against a robot on DDS and a simulated camera.
#include "pcavr/recordings/recording/image_codec.hpp"

#include "record_kills.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST(Record, KillsLoseAtMostHalfASecond) { test::kill_recordings(3, 7); }

class RecordCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  /// A simulated camera's folder.
  std::string images() const {
    fs::create_directories(path("images"));
    const ColorImage image(64, 48, Rgb8{90, 120, 150});
    std::ofstream(path("images/a.jpg"), std::ios::binary) << encode_color(image).value();
    return "file:" + path("images");
  }
  std::size_t messages_of(const std::string& topic, const std::string& file) const {
    const test::ReadBag bag = test::read_all(open_bag(path(file)));
    EXPECT_EQ(bag.error, "");
    return static_cast<std::size_t>(
        std::count_if(bag.messages.begin(), bag.messages.end(),
                      [&](const test::ReadMessage& m) { return m.topic == topic; }));
  }

  TemporaryFolder folder_;
};

TEST_F(RecordCommand, TopicsAndACameraUntilCtrlCBecomeARecording) {
  const test::PublishingRobot robot;
  const std::string setup = test::write_ros2_setup(folder_.path());
  RunningCommand command({"record", "--ros2", setup, "--topics", "/wrench,tool_pose", "--camera",
                          images(), "--json", "-o", path("push.mcap")},
                         folder_.path(), "record");
  ASSERT_TRUE(command.has_said("recording to")) << command.errors();
  EXPECT_TRUE(command.has_said("records simulated camera of")) << command.errors();
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  command.signal(SIGINT);
  ASSERT_EQ(command.wait(), 0) << command.errors();
  const json result = json::parse(command.output());
  ASSERT_EQ(result["topics"].size(), 3U);
  for (const json& topic : result["topics"]) {
    EXPECT_EQ(topic["dropped"], 0);
    const std::string name = topic["topic"];
    EXPECT_EQ(topic["messages"], messages_of(name, "push.mcap"));
    EXPECT_GT(topic["messages"], name.starts_with("/camera") ? 20 : 200) << name;
  }
  EXPECT_EQ(result["bytes"], fs::file_size(path("push.mcap")));
  const json imported = run_json({"import", path("push.mcap"), "-o", path("push")});
  EXPECT_EQ(imported["base_frame"], "base_link");
  EXPECT_TRUE(fs::exists(path("push/tool.csv")));
  EXPECT_TRUE(fs::exists(path("push/wrench.csv")));
}

TEST_F(RecordCommand, AFullDiskIsOneLineAndWhatWasWrittenIsRead) {
  const CommandOutcome outcome = run_pcavr({"record", "--camera", images(), "--camera-rate", "500",
                                            "--duration", "20", "-o", path("full.mcap")},
                                           "trap '' XFSZ; ulimit -f 200; ");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
  EXPECT_NE(outcome.standard_error.find("full.mcap: can't be written: File too large"),
            std::string::npos)
      << outcome.standard_error;
  EXPECT_GT(messages_of("/camera/image_raw/compressed", "full.mcap"), 50U);
}

TEST_F(RecordCommand, DoesNotReplaceWithoutForce) {
  // Long enough for a first image on a machine that does other things, too.
  const std::vector<std::string> arguments{"record", "--camera", images(),      "--duration",
                                           "1.5",    "--output", path("a.mcap")};
  ASSERT_EQ(run_pcavr(arguments).exit_code, 0);
  const CommandOutcome again = run_pcavr(arguments);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_EQ(again.error_lines(), 1U);
  EXPECT_NE(again.standard_error.find("already exists"), std::string::npos);
  std::vector<std::string> forced = arguments;
  forced.emplace_back("--force");
  EXPECT_EQ(run_pcavr(forced).exit_code, 0);
  std::ofstream(path("a.mcap")) << "my notes";
  EXPECT_EQ(run_pcavr(forced).exit_code, 1);
  EXPECT_EQ(read_file(path("a.mcap")).value(), "my notes");
}

TEST_F(RecordCommand, BadInputIsOneLineAndLeavesNoFile) {
  std::ofstream(path("lens.yaml"))
      << "camera: {width: 640, height: 480, fx: 500, fy: 500, cx: 320, cy: 240}\n";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{}, "there is nothing to record"},
      {{"--camera", "/dev/video-absent"}, "/dev/video-absent: can't be opened: No such file"},
      {{"--camera", "file:" + path("none")}, "can't be read: No such file"},
      {{"--camera", images(), "--camera-size", "640*480"}, "is no size in pixels"},
      {{"--camera", images(), "--camera-size", "640x480"}, "has images of 64 x 48 pixels"},
      {{"--camera", images(), "--calibration", path("lens.yaml")}, "but the camera gives 64 x 48"},
      {{"--ros2", path("none.yaml")}, "none.yaml"},
      {{"--ros2", test::write_ros2_setup(folder_.path()), "--topics", "/none", "--search", "0.3"},
       "/none is not published"},
      {{"--ros2", test::write_ros2_setup(folder_.path()), "--duration", "0.5"},
       "no message arrived"}};
  for (const auto& [arguments, text] : cases) {
    std::vector<std::string> all{"record", "-o", path("bad.mcap")};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandOutcome outcome = run_pcavr(all);
    EXPECT_EQ(outcome.exit_code, 1) << text;
    EXPECT_NE(outcome.standard_error.find(text), std::string::npos) << outcome.standard_error;
    EXPECT_FALSE(fs::exists(path("bad.mcap"))) << text;
  }
}

}  // namespace
}  // namespace pcavr
