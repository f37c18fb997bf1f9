// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/random.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr int kDraws = 100000;

TEST(Random, IsReproducibleForTheSameSeed) {
  Random a(7);
  Random b(7);
  Random c(8);
  EXPECT_EQ(a.bits(), b.bits());
  EXPECT_NE(a.bits(), c.bits());
}

TEST(Random, IsUniformInItsRange) {
  Random random(1);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.uniform(-1.0, 3.0);
    ASSERT_GE(value, -1.0);
    ASSERT_LT(value, 3.0);
    sum += value;
    squares += (value - 1.0) * (value - 1.0);
  }
  // Mean 1 and variance 16 / 12; five standard errors of each.
  EXPECT_NEAR(sum / kDraws, 1.0, 5.0 * std::sqrt(16.0 / 12.0 / kDraws));
  EXPECT_NEAR(squares / kDraws, 16.0 / 12.0, 5.0 * 16.0 / std::sqrt(180.0 * kDraws));
}

TEST(Random, IsNormalToItsFourthMoment) {
  Random random(2);
  double moments[5] = {};
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.normal();
    for (int power = 1; power <= 4; ++power) moments[power] += std::pow(value, power) / kDraws;
  }
  // Moments 0, 1, 0, 3 with variances 1, 2, 15, 96; five standard errors.
  const double error = 5.0 / std::sqrt(static_cast<double>(kDraws));
  EXPECT_NEAR(moments[1], 0.0, error);
  EXPECT_NEAR(moments[2], 1.0, error * std::sqrt(2.0));
  EXPECT_NEAR(moments[3], 0.0, error * std::sqrt(15.0));
  EXPECT_NEAR(moments[4], 3.0, error * std::sqrt(96.0));
}

TEST(Random, DrawsEveryNumberBelowABoundEquallyOften) {
  Random random(3);
  std::vector<int> counts(7, 0);
  for (int i = 0; i < kDraws; ++i) ++counts[random.below(7)];
  const double expected = kDraws / 7.0;
  for (const int count : counts) EXPECT_NEAR(count, expected, 5.0 * std::sqrt(expected));
  EXPECT_EQ(random.below(1), 0u);
  EXPECT_THROW((void)random.below(0), ContractError);
}

TEST(Random, ForksDependOnSeedAndStreamOnly) {
  Random parent(4);
  const std::uint64_t before = parent.fork(1).bits();
  (void)parent.bits();
  EXPECT_EQ(parent.fork(1).bits(), before);
  EXPECT_NE(parent.fork(2).bits(), before);
}

TEST(Random, ForksAreNotCorrelated) {
  Random a = Random(5).fork(0);
  Random b = Random(5).fork(1);
  double product = 0.0;
  for (int i = 0; i < kDraws; ++i) product += a.normal() * b.normal() / kDraws;
  EXPECT_NEAR(product, 0.0, 5.0 / std::sqrt(static_cast<double>(kDraws)));
}

}  // namespace
}  // namespace pcavr
