// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/page_recorder.hpp"

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "serve/a_world.hpp"
#include "serve/live_sessions.hpp"
#include "serve/server_message_reader.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using namespace std::chrono_literals;

class PageRecorderTest : public testing::Test {
 protected:
  PageRecorderTest() {
    EXPECT_TRUE(write_file(folder_.path() / "box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    SceneManifest scene;
    scene.folder = folder_.path();
    for (const std::string& name : world_->names()) {
      SceneObjectEntry& object = scene.objects.emplace_back();
      object.name = name;
      object.mesh = "box.obj";
    }
    recorder_.emplace(scene, world_->names(), 0.01, recordings_,
                      [this](SessionRecorder* next) { world_->switch_recorder(next); });
    world_->offer(*recorder_);
    EXPECT_TRUE(world_->start());
  }
  ~PageRecorderTest() override { world_->stop(); }

  /// Waits for up to 5 s.
  [[nodiscard]] RecordingMessage message() {
    for (int i = 0; i < 500; ++i) {
      if (auto message = recorder_->take_message()) return *message;
      std::this_thread::sleep_for(10ms);
    }
    ADD_FAILURE() << "no message";
    return {};
  }

  TemporaryFolder folder_;
  std::filesystem::path recordings_ = folder_.path() / "recordings";
  std::unique_ptr<LiveWorld> world_ = test::a_live_world();
  std::optional<PageRecorder> recorder_;
};

TEST_F(PageRecorderTest, EachRecordingHasAFolderOfItsOwn) {
  for (const char* name : {"recording_001", "recording_002"}) {
    const std::string folder = (recordings_ / name).string();
    recorder_->start();
    EXPECT_EQ(message().text, "recording to " + folder);
    EXPECT_TRUE(recorder_->is_recording());
    std::this_thread::sleep_for(300ms);
    recorder_->stop();
    const RecordingMessage end = message();
    EXPECT_FALSE(end.is_error);
    EXPECT_NE(end.text.find("s to " + folder), std::string::npos) << end.text;
    EXPECT_FALSE(recorder_->is_recording());
    const auto recording = read_recording(folder);
    ASSERT_TRUE(recording) << recording.error().to_string();
    EXPECT_GT(recording->tool.size(), 50U);
    EXPECT_EQ(recording->tool.size(), recording->wrench.size());
  }
}

TEST_F(PageRecorderTest, ALongSeriesOfSwitchesLosesNoCycleToARecorderThatHasEnded) {
  for (int i = 0; i < 20; ++i) {
    recorder_->start();
    EXPECT_FALSE(message().is_error);
    recorder_->stop();
    EXPECT_FALSE(message().is_error);
  }
  EXPECT_TRUE(std::filesystem::exists(recordings_ / "recording_020"));
}

TEST_F(PageRecorderTest, SaysWhyItCannotRecord) {
  ASSERT_TRUE(write_file(recordings_, "not a folder"));
  recorder_->start();
  const RecordingMessage failed = message();
  EXPECT_TRUE(failed.is_error);
  EXPECT_EQ(failed.text.find("not recorded: "), 0U) << failed.text;
  EXPECT_FALSE(recorder_->is_recording());
}

TEST_F(PageRecorderTest, TheEndOfTheServerEndsARecording) {
  recorder_->start();
  EXPECT_FALSE(message().is_error);
  std::this_thread::sleep_for(100ms);
  world_->stop();
  recorder_->finish();
  EXPECT_NE(message().text.find("recorded 0."), std::string::npos);
  EXPECT_TRUE(read_recording(recordings_ / "recording_001"));
}

TEST_F(PageRecorderTest, APageStartsAndEndsIt) {
  std::vector<ServerMessage> received;
  LiveSessions sessions(
      *world_, {.version = "1", .objects = world_->names()},
      [&](LiveSessions::PageId, std::vector<std::uint8_t> bytes) {
        received.push_back(decode_server_message(bytes).value());
      },
      0.5, 10.0);
  const LiveSessions::PageId page = sessions.join();
  std::uint32_t sequence = 0;
  const auto send = [&](auto content) {
    EXPECT_TRUE(sessions.on_message(page, encode(PageMessage{{++sequence, 1.0}, content}), 1.0));
  };
  send(LiveHello{});
  EXPECT_TRUE(std::get<LiveWelcome>(received.front().content).can_record);
  const auto notice = [&] {
    for (int i = 0; i < 500; ++i) {
      sessions.check_timeouts(1.0);
      if (const auto* last = std::get_if<LiveNotice>(&received.back().content)) {
        if (last->about == "recording") return last->text;
      }
      std::this_thread::sleep_for(10ms);
    }
    return std::string();
  };
  const auto is_recording = [&] {
    std::vector<std::uint8_t> bytes;
    sessions.write_state(page, 1.0, 0.0, bytes);
    return std::get<LiveState>(decode_server_message(bytes)->content).is_recording;
  };
  EXPECT_FALSE(is_recording());
  send(LiveCommand::start_recording);
  EXPECT_NE(notice().find("recording to "), std::string::npos);
  EXPECT_TRUE(is_recording());
  received.clear();
  received.push_back({});
  send(LiveCommand::stop_recording);
  EXPECT_NE(notice().find("recorded "), std::string::npos);
  EXPECT_FALSE(is_recording());
  // Another page has the tool: only that one may.
  send(LiveHello{});
  const LiveSessions::PageId other = sessions.join();
  EXPECT_TRUE(sessions.on_message(other, encode(PageMessage{{1, 1.0}, LiveHello{}}), 1.0));
  EXPECT_TRUE(
      sessions.on_message(other, encode(PageMessage{{2, 1.0}, LiveCommand::take_tool}), 1.0));
  send(LiveCommand::start_recording);
  EXPECT_NE(std::get<LiveNotice>(received.back().content).text.find("another page"),
            std::string::npos);
}

}  // namespace
}  // namespace pcavr
