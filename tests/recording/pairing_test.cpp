// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/pairing.hpp"

#include <cstdlib>
#include <set>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
constexpr Duration kGap = std::chrono::milliseconds(20);

std::vector<Stamp> at_milliseconds(std::initializer_list<int> times) {
  std::vector<Stamp> stamps;
  for (const int time : times) stamps.push_back({time * 1'000'000LL});
  return stamps;
}

TEST(PairByTime, TakesTheNearest) {
  EXPECT_EQ(pair_by_time(at_milliseconds({0, 33, 66}), at_milliseconds({5, 31, 70}), kGap),
            (Pairs{{0, 0}, {1, 1}, {2, 2}}));
}

TEST(PairByTime, AcceptsExactlyTheMaximumGap) {
  EXPECT_EQ(pair_by_time(at_milliseconds({0}), at_milliseconds({20}), kGap).size(), 1u);
  EXPECT_TRUE(pair_by_time(at_milliseconds({0}), at_milliseconds({21}), kGap).empty());
}

TEST(PairByTime, UsesAnImageInOnePairOnly) {
  EXPECT_EQ(pair_by_time(at_milliseconds({0, 12}), at_milliseconds({10}), kGap), (Pairs{{1, 0}}));
}

TEST(PairByTime, OfTwoEquallyNearTakesTheEarlier) {
  EXPECT_EQ(pair_by_time(at_milliseconds({0, 20}), at_milliseconds({10}), kGap), (Pairs{{0, 0}}));
}

TEST(PairByTime, HasNoPairsWithoutImages) {
  EXPECT_TRUE(pair_by_time({}, at_milliseconds({0}), kGap).empty());
  EXPECT_TRUE(pair_by_time(at_milliseconds({0}), {}, kGap).empty());
}

/// Index of the nearest, the earlier of equal ones, by brute force.
std::size_t nearest_by_brute_force(Stamp stamp, const std::vector<Stamp>& among) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < among.size(); ++i) {
    if (std::abs((among[i] - stamp).count()) < std::abs((among[best] - stamp).count())) best = i;
  }
  return best;
}

std::vector<Stamp> random_stamps(Random& random) {
  std::set<Stamp> stamps;
  const std::uint64_t count = 1 + random.below(12);
  while (stamps.size() < count) {
    stamps.insert({static_cast<std::int64_t>(random.below(100)) * 1'000'000});
  }
  return {stamps.begin(), stamps.end()};
}

TEST(PairByTime, EqualsTheBruteForceSearchOnRandomLists) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    const std::vector<Stamp> a = random_stamps(random);
    const std::vector<Stamp> b = random_stamps(random);
    Pairs expected;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const std::size_t j = nearest_by_brute_force(a[i], b);
      const bool is_near = std::abs((a[i] - b[j]).count()) <= kGap.count();
      if (is_near && nearest_by_brute_force(b[j], a) == i) expected.emplace_back(i, j);
    }
    EXPECT_EQ(pair_by_time(a, b, kGap), expected) << "round " << round;
  }
}

}  // namespace
}  // namespace pcavr
