// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/build/prefetcher.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

class PrefetcherTest : public testing::TestWithParam<int> {};

TEST_P(PrefetcherTest, ReturnsEveryItemOnceAndInOrder) {
  int next = 0;
  Prefetcher prefetcher([&] { return next++; }, Parallelism{GetParam()});
  std::vector<int> taken;
  const auto is_last = [](int item) { return item == 9; };
  do {
    taken.push_back(prefetcher.take(is_last));
  } while (!is_last(taken.back()));
  EXPECT_EQ(taken, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(next, 10) << "nothing is produced after the last";
}

TEST_P(PrefetcherTest, PropagatesExceptionsOfTheProducer) {
  Prefetcher prefetcher([]() -> int { throw std::runtime_error("no more"); },
                        Parallelism{GetParam()});
  EXPECT_THROW((void)prefetcher.take([](int) { return true; }), std::runtime_error);
}

TEST_P(PrefetcherTest, MayBeDestroyedBeforeTheEnd) {
  int made = 0;
  {
    Prefetcher prefetcher([&] { return ++made; }, Parallelism{GetParam()});
    EXPECT_EQ(prefetcher.take([](int) { return false; }), 1);
  }
  EXPECT_LE(made, 2);
}

INSTANTIATE_TEST_SUITE_P(Threads, PrefetcherTest, testing::Values(1, 2));

}  // namespace
}  // namespace pcavr
