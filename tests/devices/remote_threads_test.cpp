// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Two threads on one RemoteDevice, for builds with the thread sanitizer. Each yields where it
// waits, and stops after some time: on one loaded CPU the other runs only after a time slice of
// each program.
#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "devices/jittered_hand.hpp"
#include "teleoperation/devices/sample_ring.hpp"

namespace pcavr {
namespace {

TEST(SampleRing, PassesAllItemsInOrderBetweenTwoThreads) {
  struct Item {
    std::uint64_t number = 0;
    std::uint64_t inverse = 0;  ///< detects a torn read
  };
  constexpr std::uint64_t kMaxItems = 20'000;
  constexpr std::uint64_t kLast = 1'000'000;
  SampleRing<Item, 8> ring;
  const auto push = [&ring](std::uint64_t number) {
    while (!ring.push({number, ~number})) std::this_thread::yield();
  };
  std::thread writer([&] {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    for (std::uint64_t i = 0; i < kMaxItems && std::chrono::steady_clock::now() < end; ++i) push(i);
    push(kLast);
  });
  std::uint64_t count = 0;
  while (true) {
    const std::optional<Item> item = ring.pop();
    if (!item) {
      std::this_thread::yield();
      continue;
    }
    EXPECT_EQ(item->inverse, ~item->number);
    if (item->number == kLast) break;
    EXPECT_EQ(item->number, count++);
  }
  EXPECT_GT(count, 8U) << "the ring was full once, at least";
  writer.join();
  EXPECT_FALSE(ring.pop());
}

TEST(SampleRing, ClearsOnlyOlderItems) {
  SampleRing<int, 4> ring;
  ASSERT_TRUE(ring.push(1));
  ring.request_clear();
  ASSERT_TRUE(ring.push(2));
  EXPECT_TRUE(ring.is_clear_requested());
  EXPECT_EQ(ring.pop(), 2);
  EXPECT_FALSE(ring.is_clear_requested());
  // Requested before later items were taken: the reader does not go back.
  ring.request_clear();
  ASSERT_TRUE(ring.push(3));
  EXPECT_EQ(ring.pop(), 3);
  EXPECT_TRUE(ring.is_clear_requested());
  EXPECT_EQ(ring.pop(), std::nullopt);
}

TEST(RemoteDevice, IsWrittenByOneThreadAndReadByAnother) {
  RemoteDevice device;
  std::atomic<bool> is_done{false};
  std::thread network([&] {
    const std::vector<RemoteSample> samples = test::sent_over({}, 20.0, 6);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    for (std::size_t i = 0; i < samples.size() && std::chrono::steady_clock::now() < end; ++i) {
      (void)device.push(samples[i]);
      if (i % 97 == 96) device.release();
      std::this_thread::yield();
    }
    is_done = true;
  });
  DeviceFeedback feedback;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (int i = 0; !is_done; ++i) {
    const DeviceSample sample = device.exchange(i * test::kCycle, test::kCycle, feedback);
    std::this_thread::yield();
    if (!sample.is_engaged) continue;
    EXPECT_LE((sample.p_base_tip - before).norm(), 2.0 * test::kCycle + 1e-12);
    before = feedback.p_base_tool = sample.p_base_tip;
  }
  network.join();
}

}  // namespace
}  // namespace pcavr
