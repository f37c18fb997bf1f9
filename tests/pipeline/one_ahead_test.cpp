// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/one_ahead.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

class OneAheadTest : public testing::TestWithParam<int> {};

TEST_P(OneAheadTest, GivesEveryItemOnceAndInOrder) {
  int next = 0;
  OneAhead ahead([&] { return next++; }, Parallelism{GetParam()});
  std::vector<int> taken;
  const auto is_last = [](int item) { return item == 9; };
  do {
    taken.push_back(ahead.take(is_last));
  } while (!is_last(taken.back()));
  EXPECT_EQ(taken, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(next, 10) << "nothing is made after the last";
}

TEST_P(OneAheadTest, PassesOnWhatTheProducerThrows) {
  OneAhead ahead([]() -> int { throw std::runtime_error("no more"); }, Parallelism{GetParam()});
  EXPECT_THROW((void)ahead.take([](int) { return true; }), std::runtime_error);
}

TEST_P(OneAheadTest, MayBeLeftBeforeItsEnd) {
  int made = 0;
  {
    OneAhead ahead([&] { return ++made; }, Parallelism{GetParam()});
    EXPECT_EQ(ahead.take([](int) { return false; }), 1);
  }
  EXPECT_LE(made, 2);
}

INSTANTIATE_TEST_SUITE_P(Threads, OneAheadTest, testing::Values(1, 2));

}  // namespace
}  // namespace pcavr
