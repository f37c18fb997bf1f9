// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/record/recorder.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"

#include "record/fake_sources.hpp"
#include "support/read_bag.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using Bytes = std::vector<std::uint8_t>;

const RecordedTopic kTool{"/tool", "geometry_msgs/msg/PoseStamped", RecordRole::tool};
const RecordedTopic kWrench{"/wrench", "geometry_msgs/msg/WrenchStamped", RecordRole::wrench};

Bytes wrench_of(int i) {
  return cdr::wrench_stamped(Stamp{1'000'000LL * i}, {double(i), 0, 0}, {0, 0, 0}, "tool0");
}

class RecorderTest : public testing::Test {
 protected:
  std::unique_ptr<Recorder> start(const RecorderOptions& options = {}) {
    RecordInputs inputs;
    inputs.transport = std::make_unique<FakeTransport>(topics_);
    inputs.topics = {kTool, kWrench};
    auto recorder = Recorder::start(file_, false, std::move(inputs), options);
    EXPECT_TRUE(recorder) << recorder.error().to_string();
    return std::move(*recorder);
  }
  static bool comes_to(const Recorder& recorder, std::uint64_t messages) {
    return becomes_true([&] { return recorder.status().messages >= messages; });
  }
  test::ReadBag read() const { return test::read_all(open_bag(file_)); }

  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "push.mcap";
  FakeTopics topics_;
};

TEST_F(RecorderTest, WritesTheBytesThatArrivedWithTypesAndTimes) {
  auto recorder = start();
  for (int i = 0; i < 5; ++i) topics_.send(1, wrench_of(i));
  ASSERT_TRUE(comes_to(*recorder, 5));
  const auto status = recorder->finish();
  ASSERT_TRUE(status) << status.error().to_string();
  EXPECT_EQ(status->topics[1].messages, 5U);
  EXPECT_EQ(status->bytes, std::filesystem::file_size(file_));
  const test::ReadBag bag = read();
  EXPECT_EQ(bag.error, "");
  EXPECT_TRUE(bag.warnings.empty());
  ASSERT_EQ(bag.messages.size(), 5U);
  const Bytes sent = wrench_of(3);
  EXPECT_EQ(bag.messages[3].payload, std::string(sent.begin(), sent.end()));
  const double now = static_cast<double>(std::time(nullptr));
  EXPECT_NEAR(1e-9 * static_cast<double>(bag.messages[3].log_time), now, 30.0);
  for (const BagTopic& topic : bag.topics) {
    EXPECT_EQ(topic.encoding, "cdr");
    EXPECT_EQ(topic.schema_encoding, "ros2msg");
  }
}

// What a kill leaves is the file up to some byte of a write.
TEST_F(RecorderTest, CutAtAnyByteIsReadUpToTheLastWholeMessage) {
  auto recorder = start({});
  for (int i = 0; i < 12; ++i) topics_.send(1, wrench_of(i));
  ASSERT_TRUE(comes_to(*recorder, 12));
  topics_.lost = 4;  // its count is written between the chunks
  ASSERT_TRUE(becomes_true([&] { return recorder->status().topics[0].lost == 4; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  for (int i = 12; i < 20; ++i) topics_.send(1, wrench_of(i));
  ASSERT_TRUE(comes_to(*recorder, 20));
  ASSERT_TRUE(recorder->finish());
  const std::string bytes = read_file(file_).value();
  const std::vector<test::ReadMessage> all = read().messages;
  ASSERT_EQ(all.size(), 20U);
  std::size_t before = 0;
  std::filesystem::remove(file_);
  std::ofstream grown(file_, std::ios::binary);
  grown.write(bytes.data(), 7);
  for (std::size_t size = 8; size < bytes.size(); ++size) {
    grown.put(bytes[size - 1]).flush();
    const test::ReadBag cut = read();
    ASSERT_EQ(cut.error, "") << size;
    ASSERT_GE(cut.messages.size(), before) << size;
    ASSERT_TRUE(std::equal(cut.messages.begin(), cut.messages.end(), all.begin())) << size;
    before = cut.messages.size();
  }
  EXPECT_EQ(before, 20U);
}

TEST_F(RecorderTest, IsInTheFileAfterTheInterval) {
  RecorderOptions options;
  options.flush_interval = 0.05;
  auto recorder = start(options);
  topics_.send(1, wrench_of(1));
  EXPECT_TRUE(becomes_true([&] { return read().messages.size() == 1; }));
  EXPECT_TRUE(recorder->finish());
}

TEST_F(RecorderTest, CountsDroppedAndLostMessagesInTheFile) {
  RecorderOptions options;
  options.queue_size = 1;
  auto recorder = start(options);
  topics_.lost = 7;
  const Bytes large(2U << 20U, 1);  // does not fit into the queue
  for (int i = 0; i < 3; ++i) topics_.send(1, large);
  topics_.send(1, wrench_of(0));
  ASSERT_TRUE(comes_to(*recorder, 1));
  ASSERT_TRUE(becomes_true([&] { return recorder->status().topics[0].lost == 7; }));
  const auto status = recorder->finish();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->topics[1].dropped, 3U);
  EXPECT_EQ(status->topics[1].messages, 1U);
  const test::ReadBag bag = read();
  ASSERT_EQ(bag.warnings.size(), 2U);
  EXPECT_NE(bag.warnings[0].find("7 messages of /tool were dropped while it was recorded"),
            std::string::npos);
  EXPECT_NE(bag.warnings[1].find("3 messages of /wrench"), std::string::npos);
}

TEST_F(RecorderTest, AFullDiskIsOneErrorAndWhatWasWrittenIsRead) {
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  auto recorder = start();
  topics_.send(1, wrench_of(0));
  ASSERT_TRUE(becomes_true([&] { return read().messages.size() == 1; }));
  const rlimit full{std::filesystem::file_size(file_) + 10'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &full);
  for (int i = 1; i < 1000; ++i) topics_.send(1, wrench_of(i));
  EXPECT_TRUE(becomes_true([&] { return recorder->has_ended(); }));
  const auto status = recorder->finish();
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, ignored);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("can't be written: File too large"), std::string::npos)
      << status.error().message;
  EXPECT_EQ(status.error().file, file_.string());
  const test::ReadBag bag = read();
  EXPECT_EQ(bag.error, "");
  EXPECT_GT(bag.messages.size(), 50U);
}

TEST_F(RecorderTest, DoesNotReplaceAFile) {
  std::ofstream(file_) << "mine";
  EXPECT_FALSE(Recorder::start(file_, false, {}));
  EXPECT_EQ(read_file(file_).value(), "mine");
}

/// A folder with two images of one colour each.
std::filesystem::path images_in(const std::filesystem::path& folder) {
  std::filesystem::create_directory(folder);
  for (const std::uint8_t level : {std::uint8_t{50}, std::uint8_t{200}}) {
    const ColorImage image(32, 16, Rgb8{level, level, level});
    std::ofstream(folder / (std::to_string(level) + ".jpg"), std::ios::binary)
        << encode_color(image).value();
  }
  return folder;
}

TEST_F(RecorderTest, RecordsASimulatedCameraBesideTopicsOfItsName) {
  RecordInputs inputs;
  inputs.transport = std::make_unique<FakeTransport>(topics_);
  inputs.topics = {{"/camera/depth/image_raw", "sensor_msgs/msg/Image", RecordRole::image}};
  RecordedCamera& camera = inputs.cameras.emplace_back();
  camera.source = open_file_camera(images_in(folder_.path() / "images"), {.rate = 100.0}).value();
  EXPECT_NE(camera.source->description().find("simulated camera"), std::string::npos);
  camera.model = CameraModel{.width = 32, .height = 16, .fx = 30, .fy = 30, .cx = 16, .cy = 8};
  auto recorder = Recorder::start(file_, false, std::move(inputs));
  ASSERT_TRUE(recorder);
  ASSERT_TRUE(comes_to(**recorder, 20));
  ASSERT_TRUE((*recorder)->finish());
  const test::ReadBag bag = read();
  EXPECT_EQ(bag.error, "");
  const auto count = [&](const std::string& topic) {
    return std::count_if(bag.messages.begin(), bag.messages.end(),
                         [&](const test::ReadMessage& m) { return m.topic == topic; });
  };
  EXPECT_GE(count("/camera_2/image_raw/compressed"), 19);
  EXPECT_GE(count("/camera_2/camera_info"), 1);
}

TEST(FileCamera, NamesWhatItCanNotTake) {
  const TemporaryFolder folder;
  EXPECT_NE(open_file_camera(folder.path() / "none", {}).error().message.find("can't be read"),
            std::string::npos);
  EXPECT_EQ(open_file_camera(folder.path(), {}).error().message, "has no JPEG or PNG images");
  std::ofstream(folder.path() / "a.jpg") << "text";
  EXPECT_EQ(open_file_camera(folder.path(), {}).error().message,
            "is neither a JPEG nor a PNG image");
}

TEST(FileCamera, RepeatsItsImagesAtItsRateAndCountsThoseThatNobodyTook) {
  const TemporaryFolder folder;
  auto camera = open_camera("file:" + images_in(folder.path() / "images").string(), {.rate = 50.0});
  ASSERT_TRUE(camera);
  std::vector<double> times;
  while (times.size() < 4) {
    const auto frame = (*camera)->next(std::chrono::milliseconds(5));
    ASSERT_TRUE(frame);
    if (*frame) times.push_back((*frame)->t);
  }
  const std::uint64_t lost = (*camera)->lost();
  EXPECT_NEAR(times[3] - times[0], 0.02 * (3.0 + static_cast<double>(lost)), 1e-9);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ASSERT_TRUE((*camera)->next(std::chrono::milliseconds(5)));
  EXPECT_GE((*camera)->lost(), lost + 3);
}

}  // namespace
}  // namespace pcavr
