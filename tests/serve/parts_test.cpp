// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "serve/gzip.hpp"
#include "serve/pulse_generator.hpp"
#include "serve/triple_buffer.hpp"

namespace pcavr {
namespace {

TEST(TripleBuffer, TheReaderGetsTheNewestAndKeepsIt) {
  TripleBuffer<int> buffer(0);
  EXPECT_EQ(buffer.newest(), 0);
  for (const int value : {1, 2, 3}) {
    buffer.back() = value;
    buffer.publish();
  }
  const int& seen = buffer.newest();
  EXPECT_EQ(seen, 3);
  for (const int value : {4, 5, 6, 7}) {
    buffer.back() = value;
    buffer.publish();
    EXPECT_EQ(seen, 3);
  }
  EXPECT_EQ(buffer.newest(), 7);
  EXPECT_EQ(buffer.newest(), 7);
}

TEST(TripleBuffer, ValuesAreConsistentAndNeverOlderThanBefore) {
  struct Pair {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
  };
  TripleBuffer<Pair> buffer(Pair{});
  constexpr std::uint64_t kLast = 200'000;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      buffer.back() = {i, ~i};
      buffer.publish();
    }
  });
  std::uint64_t before = 0;
  while (before < kLast) {
    const Pair seen = buffer.newest();
    if (seen.a != 0) {
      ASSERT_EQ(seen.b, ~seen.a);
    }
    ASSERT_GE(seen.a, before);
    before = seen.a;
  }
  writer.join();
}

HapticWorldState touching(MotionPhase phase, double force) {
  HapticWorldState state;
  state.bodies.resize(1);
  state.bodies[0].phase = phase;
  if (phase != MotionPhase::free) state.touched_body = 0;
  state.force_base = {force, 0.0, 0.0};
  return state;
}

TEST(PulseGenerator, PulsesAtTheFirstContactAndAtTheBreakaway) {
  PulseGenerator generator(1, 10.0);
  generator.step(touching(MotionPhase::free, 0.0), 0.001);
  EXPECT_EQ(generator.count(), 0U);
  EXPECT_LT(generator.amplitude(), 1e-6);
  generator.step(touching(MotionPhase::static_contact, 1.0), 0.001);
  EXPECT_EQ(generator.count(), 1U);
  EXPECT_EQ(generator.amplitude(), 1.0);
  for (int i = 0; i < 500; ++i) generator.step(touching(MotionPhase::critical, 8.0), 0.001);
  EXPECT_EQ(generator.count(), 1U);
  EXPECT_NEAR(generator.amplitude(), 0.4, 1e-6);
  generator.step(touching(MotionPhase::sliding, 7.0), 0.001);
  EXPECT_EQ(generator.count(), 2U);
  EXPECT_EQ(generator.amplitude(), 1.0);
}

TEST(PulseGenerator, DebouncesAChatteringTip) {
  PulseGenerator generator(1, 10.0);
  for (int i = 0; i < 100; ++i) {
    generator.step(touching(i % 3 == 0 ? MotionPhase::free : MotionPhase::static_contact, 1.0),
                   0.001);
  }
  EXPECT_EQ(generator.count(), 1U);
  for (int i = 0; i < 60; ++i) generator.step(touching(MotionPhase::free, 0.0), 0.001);
  generator.step(touching(MotionPhase::static_contact, 1.0), 0.001);
  EXPECT_EQ(generator.count(), 2U);
}

TEST(PulseGenerator, TheVibrationGrowsWithTheForceAndStaysBelowAPulse) {
  PulseGenerator generator(1, 10.0);
  double before = -1.0;
  for (const double force : {0.0, 2.0, 5.0, 10.0, 1000.0}) {
    for (int i = 0; i < 1000; ++i)
      generator.step(touching(MotionPhase::static_contact, force), 0.001);
    EXPECT_GE(generator.amplitude(), before);
    EXPECT_LE(generator.amplitude(), 0.5);
    before = generator.amplitude();
  }
}

TEST(Gzip, SurvivesARoundTrip) {
  for (const std::string& text : {std::string(), std::string("a"), std::string(100'000, 'x')}) {
    EXPECT_EQ(gunzip(gzip(text), 1 << 20), text);
  }
}

TEST(Gzip, RejectsWhatIsTooLargeOrNotGzip) {
  EXPECT_FALSE(gunzip(gzip(std::string(1000, 'x')), 999));
  EXPECT_FALSE(gunzip("", 1000));
  EXPECT_FALSE(gunzip(std::string(40, '\0'), 1000));
  std::string cut = gzip("some text that was truncated");
  cut.erase(cut.size() / 2, 2);
  EXPECT_FALSE(gunzip(cut, 1000));
}

}  // namespace
}  // namespace pcavr
