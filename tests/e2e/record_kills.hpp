// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <thread>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "recorded_robot.hpp"
#include "support/json_command.hpp"
#include "support/running_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr::test {

/// Kills `pcavr record` at `count` random instants of a recording; each file is read, has the
/// messages up to half a second before, is imported, and inspected.
inline void kill_recordings(int count, std::uint64_t seed) {
  const TemporaryFolder folder;
  const PublishingRobot robot;
  const std::string setup = write_ros2_setup(folder.path());
  Random random(seed);
  double max_loss = 0.0;  // [s]
  for (int i = 0; i < count; ++i) {
    const std::string name = "push" + std::to_string(i);
    const std::filesystem::path file = folder.path() / (name + ".mcap");
    RunningCommand command({"record", "--ros2", setup, "-o", file.string()}, folder.path(), name);
    ASSERT_TRUE(command.has_said("recording to")) << command.errors();
    const auto has_messages = [&] { return !read_all(open_bag(file)).messages.empty(); };
    for (int j = 0; j < 400 && !has_messages(); ++j) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(0.2 + 0.8 * random.uniform()));
    command.signal(SIGKILL);
    const std::int64_t killed = realtime();
    command.wait();
    const ReadBag bag = read_all(open_bag(file));
    EXPECT_EQ(bag.error, "");
    ASSERT_FALSE(bag.messages.empty()) << command.errors();
    for (const Ros2Topic& topic : {kToolTopic, kWrenchTopic}) {
      std::int64_t last = 0;
      for (const ReadMessage& message : bag.messages) {
        if (message.topic == topic.name) last = std::max(last, message.log_time);
      }
      const double loss = 1e-9 * static_cast<double>(killed - last);
      EXPECT_LE(loss, 0.5) << topic.name;
      max_loss = std::max(max_loss, loss);
    }
    const std::string recording = (folder.path() / name).string();
    const auto imported = run_json({"import", file.string(), "-o", recording});
    EXPECT_EQ(imported["streams"].size(), 2U);
    const auto inspected = run_json({"inspect", recording});
    EXPECT_FALSE(inspected.is_discarded());
  }
  std::printf("  %d kills lost at most %.3f s\n", count, max_loss);
}

}  // namespace pcavr::test
