// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/sites/black_box.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <map>
#include <new>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/core/record_queue.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "support/temporary_folder.hpp"
#include "teleoperation/sites/site_log.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

TEST(RecordQueue, KeepsOrderAndBytesBetweenTwoThreads) {
  constexpr int kRecords = 50'000;
  RecordQueue queue(1U << 12U);
  std::thread writer([&] {
    Random random(1);
    for (int i = 0; i < kRecords; ++i) {
      std::vector<std::uint8_t> body(random.below(300));
      std::iota(body.begin(), body.end(), static_cast<std::uint8_t>(i));
      const std::array<std::uint8_t, 2> head{static_cast<std::uint8_t>(i),
                                             static_cast<std::uint8_t>(i >> 8)};
      while (!queue.push(head, body)) std::this_thread::yield();
    }
  });
  Random random(1);
  std::vector<std::uint8_t> record;
  for (int i = 0; i < kRecords; ++i) {
    while (!queue.pop(record)) std::this_thread::yield();
    ASSERT_EQ(record.size(), 2 + random.below(300)) << i;
    ASSERT_EQ(record[0] + 256 * record[1], i & 0xffff);
    for (std::size_t j = 2; j < record.size(); ++j) {
      ASSERT_EQ(record[j], static_cast<std::uint8_t>(i + static_cast<int>(j) - 2));
    }
  }
  writer.join();
  EXPECT_FALSE(queue.pop(record));
}

TEST(RecordQueue, DropsAndCountsWhatDoesNotFit) {
  RecordQueue queue(64);
  const std::vector<std::uint8_t> body(26, 7);
  EXPECT_TRUE(queue.push(body, {}));
  EXPECT_TRUE(queue.push(body, {}));
  EXPECT_FALSE(queue.push(body, {}));
  EXPECT_EQ(queue.dropped(), 1U);
  std::vector<std::uint8_t> record;
  EXPECT_TRUE(queue.pop(record));
  EXPECT_TRUE(queue.push(body, {}));
  EXPECT_TRUE(queue.pop(record));
  EXPECT_TRUE(queue.pop(record));
  EXPECT_EQ(record, body);
}

/// Content of a bag, by topic.
struct BagContent {
  std::vector<BagTopic> topics;
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> payloads;
  std::map<std::string, std::vector<Stamp>> stamps;
  Stamp last = {};

  [[nodiscard]] nlohmann::json json(const std::string& topic, std::size_t i) const {
    return nlohmann::json::parse(payloads.at(topic).at(i));
  }
  [[nodiscard]] std::string type_of(const std::string& topic) const {
    for (const BagTopic& one : topics) {
      if (one.name == topic) return one.type;
    }
    return "none";
  }
};

BagContent read_bag(const fs::path& file) {
  BagContent content;
  auto reader = open_bag(file);
  EXPECT_TRUE(reader) << (reader ? "" : reader.error().to_string());
  if (!reader) return content;
  for (;;) {
    const auto message = (*reader)->next();
    if (!message || !*message) break;
    const std::string& topic = (*reader)->topics()[(*message)->topic].name;
    content.payloads[topic].emplace_back((*message)->payload.begin(), (*message)->payload.end());
    content.stamps[topic].push_back((*message)->log_time);
    content.last = std::max(content.last, (*message)->log_time);
  }
  content.topics = (*reader)->topics();
  return content;
}

template <typename T>
T number_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::array<std::uint8_t, sizeof(T)> part{};
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), sizeof(T), part.begin());
  return std::bit_cast<T>(part);
}

SiteScene a_scene() {
  return {.name = "table", .version = "1", .objects = {"box 1"}, .T_base_objects = {Pose()}};
}

LinkMessage a_command(std::uint32_t sequence, double t) {
  LinkCommand command{.t = t, .p_base_tip = {0.5F, 0.25F, 0.125F}, .correction_delay = 0.5F};
  command.predictions.resize(1);
  command.predictions[0].rendered_force = {1.0F, 2.0F, 3.0F};
  command.predictions[0].phase = MotionPhase::sliding;
  return {{sequence, 7, t}, command};
}

TEST(BlackBox, WritesWhatASiteDoesWithTypesThatOtherToolsKnow) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "log.mcap";
  auto box = BlackBox::create(file, a_scene());
  ASSERT_TRUE(box) << box.error().to_string();
  EXPECT_FALSE(BlackBox::create(file, a_scene())) << "never replaces a log";
  SiteLog& log = (*box)->log();
  log.on_start(10.0);
  log.on_link(10.0, {.clock_offset = 100.0, .clock_std = 1e-4, .round_trip = 0.4, .lead = 0.25});
  log.on_event(10.5, SiteLog::Level::warning, "the link is lost");
  log.on_received(10.75, encode(LinkMessage{{1, 7, 110.5}, LinkWelcome{109.5, 0.01}}));
  log.on_sent(11.0, encode(a_command(1, 111.25)));
  log.on_phase(11.25, 0, MotionPhase::critical);
  LinkState state{.t = 110.5, .is_on_hold = true, .force_base = {0.0F, 0.0F, 2.5F}};
  state.objects.resize(1);
  state.objects[0].is_tracked = true;
  state.objects[0].age = 0.125F;
  log.on_received(11.5, encode(LinkMessage{{2, 7, 111.0}, state}));
  log.on_received(12.0,
                  encode(LinkMessage{{3, 7, 111.5}, LinkCorrection{1, 110.0, 110.5, {1, 2, 255}}}));
  log.on_applied(12.0, 7, {1, 110.0, {}}, false);
  log.on_delays(12.5, {{}, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5});
  const auto summary = (*box)->close();
  ASSERT_TRUE(summary) << summary.error().to_string();
  EXPECT_EQ(summary->dropped, 0U);
  const BagContent bag = read_bag(file);
  EXPECT_EQ(bag.type_of("/command"), "geometry_msgs/msg/PoseStamped");
  EXPECT_EQ(bag.type_of("/wrench"), "geometry_msgs/msg/WrenchStamped");
  EXPECT_EQ(bag.type_of("/tracked/box_1"), "geometry_msgs/msg/PoseStamped");
  EXPECT_EQ(bag.type_of("/tf"), "tf2_msgs/msg/TFMessage");
  // CDR: encapsulation, seconds, nanoseconds, "base" with its length, padding, position.
  const std::vector<std::uint8_t>& command = bag.payloads.at("/command").at(0);
  ASSERT_EQ(command.size(), 4U + 24U + 56U);
  EXPECT_EQ(number_at<std::uint32_t>(command, 12), 5U);
  EXPECT_EQ(number_at<double>(command, 28), 0.5);
  EXPECT_EQ(number_at<double>(command, 76), 1.0);
  // Executed at 111.25 s of the shared clock: 0.25 s after it was sent at 11.0 s of this site's.
  const Stamp sent = bag.stamps.at("/command").at(0);
  const std::int64_t executed = number_at<std::uint32_t>(command, 4) * std::int64_t{1'000'000'000} +
                                number_at<std::uint32_t>(command, 8);
  EXPECT_NEAR(1e-9 * static_cast<double>(executed - sent.nanoseconds), 0.25, 1e-6);
  EXPECT_EQ(number_at<double>(bag.payloads.at("/wrench").at(0), 28 + 16), 2.5);
  EXPECT_EQ(number_at<double>(bag.payloads.at("/predicted_force/box_1").at(0), 28 + 8), 2.0);
  EXPECT_EQ(bag.json("/events", 0)["text"], "the link is lost");
  EXPECT_EQ(bag.json("/status", 0)["on_hold"], true);
  EXPECT_EQ(bag.json("/phases", 0)["phase"], "sliding");
  EXPECT_EQ(bag.json("/phases", 0)["site"], "operator");
  EXPECT_NEAR(bag.json("/phases", 0)["time"].get<double>() - sent.seconds(), 0.25, 1e-5);
  EXPECT_EQ(bag.json("/phases", 1)["site"], "robot");
  EXPECT_EQ(bag.json("/phases", 1)["phase"], "critical");
  // Time zero of the scene, 109.5 s of the shared clock, with the first command.
  EXPECT_EQ(bag.json("/session", 1)["message"], "start");
  EXPECT_NEAR(bag.json("/session", 1)["time"].get<double>() - sent.seconds(), -1.5, 1e-5);
  EXPECT_EQ(bag.json("/session", 1)["correction_delay"], 0.5);
  EXPECT_EQ(bag.json("/corrections", 0)["action"], "received");
  EXPECT_EQ(bag.json("/corrections", 1)["action"], "not valid");
  EXPECT_EQ(bag.json("/corrections", 1)["data"], "0102ff");
  EXPECT_NEAR(to_seconds(bag.stamps.at("/corrections").at(1) - sent), 1.0, 1e-6);
  EXPECT_EQ(bag.json("/delays", 0)["received_back"], 2.5);
  EXPECT_EQ(bag.json("/link", 0)["round_trip"], 0.4);
}

TEST(BlackBox, ObjectsHaveTopicsAndFramesOfTheirOwn) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(topic_parts_of({"box 1", "lid"}), (Names{"box_1", "lid"}));
  EXPECT_EQ(topic_parts_of({"a b", "a_b", "a-b"}), (Names{"a_b_2", "a_b", "a_b_3"}));
  EXPECT_EQ(topic_parts_of({"a_b", "a-b", "a b"}), (Names{"a_b", "a_b_3", "a_b_2"}));
  EXPECT_EQ(topic_parts_of({"a b", "a_b", "a_b_2"}), (Names{"a_b_3", "a_b", "a_b_2"}));
  // Frames: those of the predictions, and the tool's.
  EXPECT_EQ(topic_parts_of({"a", "a predicted", "tool"}), (Names{"a", "a_predicted_2", "tool_2"}));
}

TEST(BlackBox, StatesWhatItHadToDrop) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "log.mcap";
  BlackBoxOptions options;
  options.queue_size = 1;
  auto box = BlackBox::create(file, a_scene(), options);
  ASSERT_TRUE(box) << box.error().to_string();
  (*box)->log().on_start(0.0);
  const std::vector<std::uint8_t> huge(300'000, 1);  // not a message
  for (int i = 0; i < 50; ++i) (*box)->log().on_received(1.0, huge);
  const auto summary = (*box)->close();
  ASSERT_TRUE(summary) << summary.error().to_string();
  EXPECT_GT(summary->dropped, 0U);
  const BagContent bag = read_bag(file);
  std::string events;
  for (std::size_t i = 0; i < bag.payloads.at("/events").size(); ++i) {
    events += bag.json("/events", i)["text"].get<std::string>() + '\n';
  }
  EXPECT_NE(events.find("were dropped"), std::string::npos) << events;
}

double realtime() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A site that logs at 1 kHz until it is killed. This is its progress, in memory that outlives it.
struct LoggingProcess {
  std::atomic<double> logged = 0.0;         ///< [s] when it logged last
  std::atomic<std::uint32_t> messages = 0;  ///< one a millisecond at most
  /// [s] when a thread that is like the file's, and sleeps as it does, ran last; and the longest
  /// time that it did not although it should have.
  std::atomic<double> ran = 0.0, max_gap = 0.0;
};

LoggingProcess& make_shared_process() {
  void* const memory = ::mmap(nullptr, sizeof(LoggingProcess), PROT_READ | PROT_WRITE,
                              MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return *new (memory) LoggingProcess;
}

[[noreturn]] void log_for_ever(const fs::path& file, LoggingProcess& process) {
  auto box = BlackBox::create(file, a_scene());
  if (!box) ::_exit(1);
  SiteLog& log = (*box)->log();
  const double start = realtime();
  log.on_start(0.0);
  std::thread([&process] {
    process.ran = realtime();
    while (true) {
      std::this_thread::sleep_for(milliseconds(5));
      const double now = realtime();
      process.max_gap = std::max(process.max_gap.load(), now - process.ran);
      process.ran = now;
    }
  }).detach();
  for (std::uint32_t i = 1;; ++i) {
    const double now = realtime() - start;
    log.on_sent(now, encode(a_command(i, now)));
    process.logged = start + now;
    process.messages = i;
    std::this_thread::sleep_for(milliseconds(1));
  }
}

TEST(BlackBox, IsReadableUpToTheLast100MillisecondsAfterAKill) {
  const TemporaryFolder folder;
  for (const int lifetime : {300, 437, 551}) {  // [ms]
    const fs::path file = folder.path() / (std::to_string(lifetime) + ".mcap");
    LoggingProcess& process = make_shared_process();
    const pid_t child = ::fork();
    if (child == 0) log_for_ever(file, process);
    ASSERT_GT(child, 0);
    std::this_thread::sleep_for(milliseconds(lifetime));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << status;
    const BagContent bag = read_bag(file);
    ASSERT_EQ(bag.payloads.count("/command"), 1U);
    // A loaded machine lets no thread run for longer.
    const double gap = std::max(process.max_gap.load(), process.logged - process.ran);
    const double max_loss = 0.1 + std::max(gap - 0.02, 0.0);
    EXPECT_LT(process.logged - bag.last.seconds(), max_loss);
    const auto read = static_cast<double>(bag.payloads.at("/command").size());
    EXPECT_GT(read + 1e3 * max_loss, process.messages);
    ::munmap(&process, sizeof process);
  }
}

}  // namespace
}  // namespace pcavr
