// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/stamp_blocks.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr double kInterval = 0.002;  // [s]

/// Rows of an even clock, stamped when a buffer of `block` rows was read.
std::vector<double> blocks_of(std::size_t block) {
  std::vector<double> t;
  for (std::size_t i = 0; i < 600; ++i) {
    const auto first = static_cast<double>(i / block * block);
    t.push_back(kInterval * first + 1e-5 * static_cast<double>(i % block));
  }
  return t;
}

TEST(StampBlocks, AreNamedWithTheirRowsAndInterval) {
  for (const std::size_t block : {3U, 8U, 20U}) {
    const auto warning = warn_of_stamp_blocks("tool.csv", blocks_of(block));
    ASSERT_TRUE(warning.has_value()) << block;
    EXPECT_TRUE(warning->starts_with("tool.csv: rows come in blocks of ")) << *warning;
  }
  EXPECT_NE(warn_of_stamp_blocks("tool.csv", blocks_of(8))->find("blocks of 8, 16 ms apart"),
            std::string::npos);
}

TEST(StampBlocks, AreNotSeenInJitterGapsAndLosses) {
  Random random(5);
  std::vector<double> jitter, gaps, losses;
  for (std::size_t i = 0; i < 600; ++i) {
    const double t = kInterval * static_cast<double>(i);
    jitter.push_back(t + 0.45 * kInterval * random.uniform(-1.0, 1.0));
    gaps.push_back(t + 5.0 * std::floor(t / 0.06));  // 30 rows, then 5 s without
    if (random.uniform(0.0, 1.0) < 0.3) losses.push_back(t);
  }
  EXPECT_FALSE(warn_of_stamp_blocks("jitter", jitter).has_value());
  EXPECT_FALSE(warn_of_stamp_blocks("losses", losses).has_value());
  EXPECT_FALSE(warn_of_stamp_blocks("even", blocks_of(1)).has_value());
  EXPECT_FALSE(warn_of_stamp_blocks("few", std::vector<double>{0.0, 1.0}).has_value());
}

}  // namespace
}  // namespace pcavr
