// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

using Chunks = std::vector<std::pair<std::size_t, std::size_t>>;

Chunks chunks_of(int threads, std::size_t count, std::size_t grain) {
  std::mutex mutex;
  Chunks chunks;
  parallel_for({threads}, count, grain, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    chunks.emplace_back(begin, end);
  });
  std::sort(chunks.begin(), chunks.end());
  return chunks;
}

TEST(ParallelFor, MakesTheSameChunksForAnyThreadCount) {
  const Chunks expected{{0, 4}, {4, 8}, {8, 10}};
  for (const int threads : {1, 2, 4}) EXPECT_EQ(chunks_of(threads, 10, 4), expected) << threads;
}

TEST(ParallelFor, OfNothingCallsNothing) { EXPECT_TRUE(chunks_of(2, 0, 4).empty()); }

TEST(ParallelFor, SumsInChunkOrderHaveTheSameBits) {
  const auto sum = [](int threads) {
    std::vector<double> sums(100, 0.0);
    parallel_for({threads}, 10000, 100, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        sums[begin / 100] += 1.0 / (1.0 + static_cast<double>(i));
      }
    });
    double total = 0.0;
    for (const double part : sums) total += part;
    return total;
  };
  EXPECT_EQ(sum(1), sum(2));
  EXPECT_EQ(sum(1), sum(4));
}

TEST(ParallelFor, RethrowsAnException) {
  for (const int threads : {1, 3}) {
    EXPECT_THROW(parallel_for({threads}, 100, 1,
                              [](std::size_t begin, std::size_t) {
                                if (begin == 50) throw std::runtime_error("stop");
                              }),
                 std::runtime_error);
  }
}

TEST(ParallelFor, RefusesZeroThreadsAndZeroGrain) {
  const auto nothing = [](std::size_t, std::size_t) {};
  EXPECT_THROW(parallel_for({0}, 1, 1, nothing), ContractError);
  EXPECT_THROW(parallel_for({1}, 1, 0, nothing), ContractError);
}

}  // namespace
}  // namespace pcavr
