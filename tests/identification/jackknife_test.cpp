// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/jackknife.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

TEST(Jackknife, GivesTheStdOfAMeanWidenedForFewGroups) {
  const std::vector<double> values{1.0, 4.0, 2.0, 7.0, 6.0};
  std::vector<double> without;
  double squares = 0.0;
  for (const double one : values) {
    without.push_back((20.0 - one) / 4.0);
    squares += (one - 4.0) * (one - 4.0);
  }
  const double std_of_mean = std::sqrt(squares / 4.0 / 5.0);
  EXPECT_NEAR(jackknife_std(without), std_of_mean * std::sqrt(4.0 / 2.0), 1e-12);
  EXPECT_NEAR(jackknife_std(std::vector{1.0, 3.0}), 6.5, 1e-12);
}

TEST(Jackknife, LeavesOutSuccessivePushesTogether) {
  EXPECT_EQ(jackknife_groups(4), 4U);
  EXPECT_EQ(jackknife_groups(37), kJackknifeGroups);
  std::vector<int> sizes(kJackknifeGroups, 0);
  for (std::size_t push = 0; push < 37; ++push) {
    const std::size_t group = jackknife_group(push, 37);
    ASSERT_LT(group, kJackknifeGroups);
    EXPECT_LE(group, jackknife_group(push + 1, 37));
    ++sizes[group];
  }
  for (const int size : sizes) EXPECT_GE(size, 3);
}

}  // namespace
}  // namespace pcavr
