// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/session_recorder.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "serve/live_cycle_fixture.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using test::kInTheBox;
using test::LiveCycleTest;

class SessionRecorderTest : public LiveCycleTest {
 protected:
  SessionRecorderTest() {
    EXPECT_TRUE(write_file(scene_.path() / "box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    SceneManifest manifest;
    manifest.folder = scene_.path();
    for (const std::string& name : cycle_.names()) {
      SceneObjectEntry& object = manifest.objects.emplace_back();
      object.name = name;
      object.mesh = "box.obj";
      object.mass = 1.5;
    }
    recorder_.emplace(manifest, cycle_.names(), 0.01);
    EXPECT_TRUE(recorder_->prepare(folder_.path()));
    recorder_->start(folder_.path());
    cycle_.record(*recorder_);
  }
  [[nodiscard]] Recording finished() {
    const auto summary = recorder_->finish();
    EXPECT_TRUE(summary.has_value());
    EXPECT_EQ(summary->dropped, 0U);
    const auto recording = read_recording(folder_.path());
    EXPECT_TRUE(recording.has_value()) << recording.error().to_string();
    return *recording;
  }

  TemporaryFolder scene_;
  TemporaryFolder folder_;
  std::optional<SessionRecorder> recorder_;
};

TEST_F(SessionRecorderTest, APushIsARecordingOfToolForceAndBody) {
  run(50);
  const WorldSnapshot end = move(kInTheBox, 1500);
  const Recording recording = finished();
  EXPECT_EQ(recording.manifest.tool_radius, 0.01);
  ASSERT_EQ(recording.manifest.objects.size(), 1U);
  EXPECT_EQ(recording.manifest.objects[0].mass, 1.5);
  EXPECT_TRUE(is_present(folder_.path() / "box.obj").value());
  ASSERT_EQ(recording.tool.size(), recording.wrench.size());
  EXPECT_NEAR(static_cast<double>(recording.tool.size()), 775.0, 2.0);
  EXPECT_NEAR(recording.tool.poses().back().pose.translation().x(), end.world.p_base_hip.x(), 1e-3);
  // The tip pushes the box along x.
  const auto& strongest =
      *std::max_element(recording.wrench.begin(), recording.wrench.end(),
                        [](const auto& a, const auto& b) { return a.force.x() < b.force.x(); });
  EXPECT_GT(strongest.force.x(), 0.5);
  const auto tracked =
      read_file(folder_.path() / "tracked/objects" / cycle_.names()[0] / "tracked.txt");
  ASSERT_TRUE(tracked.has_value());
  EXPECT_NEAR(static_cast<double>(std::count(tracked->begin(), tracked->end(), '\n')), 47.0, 2.0);
}

TEST_F(SessionRecorderTest, ASessionWithoutAnEndIsARecordingOfWhatWasDone) {
  move(kInTheBox, 400);
  const auto rows = [this] {
    const std::string text = read_file(folder_.path() / "tool.csv").value();
    return std::count(text.begin(), text.end(), '\n');
  };
  for (int i = 0; i < 100 && rows() < 190; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const auto recording = read_recording(folder_.path());  // as after the process was killed
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  EXPECT_NEAR(static_cast<double>(recording->tool.size()), 200.0, 10.0);
}

TEST_F(SessionRecorderTest, AFullDiskLosesNothingThatIsWritten) {
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit full{8192, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &full);
  move(kInTheBox, 1000);
  const auto summary = recorder_->finish();
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, ignored);
  ASSERT_FALSE(summary.has_value());
  EXPECT_NE(summary.error().message.find("not complete"), std::string::npos);
  EXPECT_EQ(read_file(folder_.path() / "tool.csv")->size(), 8192U);
}

TEST_F(SessionRecorderTest, SlowedTimeIsRecordedAsSimulated) {
  cycle_.set_time_scale(0.1);
  run(1000);
  const Recording recording = finished();
  EXPECT_NEAR(recording.wrench.back().stamp.seconds(), 0.1, 0.003);
  EXPECT_LT(recording.wrench.size(), 100U);
}

}  // namespace
}  // namespace pcavr
