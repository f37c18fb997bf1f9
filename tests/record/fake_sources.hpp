// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pcavr/teleoperation/record/camera_source.hpp"
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

namespace pcavr {

/// Messages that a test sends, in this process.
struct FakeTopics {
  std::mutex mutex;
  std::deque<std::pair<std::size_t, std::vector<std::uint8_t>>> waiting;
  std::atomic<std::uint64_t> lost = 0;

  void send(std::size_t topic, std::vector<std::uint8_t> message) {
    const std::lock_guard lock(mutex);
    waiting.emplace_back(topic, std::move(message));
  }
};

class FakeTransport final : public Ros2Transport {
 public:
  explicit FakeTransport(FakeTopics& topics) : topics_(topics) {}
  void wait(std::chrono::milliseconds, const Receiver& receive) override {
    std::deque<std::pair<std::size_t, std::vector<std::uint8_t>>> messages;
    {
      const std::lock_guard lock(topics_.mutex);
      messages.swap(topics_.waiting);
    }
    for (const auto& [topic, message] : messages) receive(topic, message);
    if (messages.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  bool publish(std::size_t, std::span<const std::uint8_t>) override { return false; }
  [[nodiscard]] std::vector<std::string> take_notices() override { return {}; }
  [[nodiscard]] std::uint64_t lost(std::size_t topic) override {
    return topic == 0 ? topics_.lost.load() : 0;
  }

 private:
  FakeTopics& topics_;
};

/// Waits until `is_true`, at most 20 s; whether it became so.
template <typename Condition>
bool becomes_true(Condition is_true) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!is_true() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return is_true();
}

}  // namespace pcavr
