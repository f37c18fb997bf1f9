// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/picture_pacer.hpp"

#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/teleoperation/link/link_conditions.hpp"

namespace pcavr {
namespace {

struct Receipt {
  std::uint32_t sequence = 0;
  double received = 0.0;
};

struct Outcome {
  double bytes = 0.0;       ///< of the last minute
  double max_queued = 0.0;  ///< [s] of the last minute
  std::size_t pictures = 0;
};

/// Two minutes of pictures, as large as they may be, over a link.
Outcome run(const LinkConditions::Options& link, const PictureOptions& options = {}) {
  constexpr double kStep = 0.001;    // [s]
  constexpr double kDuration = 120;  // [s]
  PicturePacer pacer(options);
  LinkConditions there(link, Random(5));
  DelayedMessages<Receipt> back;
  Outcome outcome;
  std::uint32_t sequence = 0;
  for (double t = 0.0; t < kDuration; t += kStep) {
    while (const auto receipt = back.pop(t)) {
      pacer.note_receipt(receipt->sequence, receipt->received, t);
    }
    const auto bytes = pacer.max_bytes(t);
    if (!bytes) continue;
    pacer.note_sent(++sequence, *bytes, t);
    const LinkConditions::Arrivals arrivals = there.arrivals(t, *bytes);
    if (!arrivals.first) continue;
    back.push(*arrivals.first + link.delay, {sequence, *arrivals.first});
    if (t < 0.5 * kDuration) continue;
    ++outcome.pictures;
    outcome.bytes += static_cast<double>(*bytes);
    outcome.max_queued = std::max(outcome.max_queued, *arrivals.first - t - link.delay);
  }
  return outcome;
}

TEST(PicturePacer, FillsMostOfASlowLinkWithoutAQueue) {
  LinkConditions::Options link;
  link.delay = 0.2;
  link.rate_limit = 100e3;
  const Outcome outcome = run(link);
  EXPECT_GT(outcome.bytes, 0.4 * 60.0 * link.rate_limit);
  EXPECT_LT(outcome.bytes, 60.0 * link.rate_limit);
  // A picture's own transmission, and as much again of a queue.
  EXPECT_LT(outcome.max_queued, 0.2);
}

TEST(PicturePacer, TakesNoMoreThanItsBandwidthOnAFastLink) {
  LinkConditions::Options link;
  link.delay = 0.2;
  const PictureOptions options;
  const Outcome outcome = run(link, options);
  EXPECT_NEAR(outcome.bytes, 60.0 * 1000.0 * options.max_bandwidth, 0.1 * 6e7);
  EXPECT_NEAR(static_cast<double>(outcome.pictures), 60.0 * options.max_rate, 12.0);
}

// Losses that are no congestion leave the quality as it is.
TEST(PicturePacer, BearsLosses) {
  LinkConditions::Options link;
  link.delay = 0.2;
  link.loss = 0.2;
  link.burst = 3.0;
  const Outcome outcome = run(link);
  EXPECT_GT(outcome.bytes, 0.7 * 60.0 * 1000.0 * PictureOptions().max_bandwidth);
}

TEST(PicturePacer, SendsNothingAtARateOfZero) {
  PictureOptions options;
  options.max_rate = 0.0;
  EXPECT_FALSE(PicturePacer(options).max_bytes(10.0));
}

TEST(PicturePacer, SlowsDownOverALinkThatLosesAll) {
  PicturePacer pacer;
  const double before = pacer.bandwidth();
  std::uint32_t sequence = 0;
  for (double t = 0.0; t < 10.0; t += 0.01) {
    if (const auto bytes = pacer.max_bytes(t)) pacer.note_sent(++sequence, *bytes, t);
  }
  EXPECT_LT(pacer.bandwidth(), 0.5 * before);
}

}  // namespace
}  // namespace pcavr
