// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Many runs beside each other: the test of paired differences, and what is compared with what.
#include "pcavr/results/evaluation/compare_runs.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

EvaluatedRun run_of(const std::string& recording, const std::string& delay, double error) {
  return {.run = recording + "-" + delay,
          .recording = recording,
          .settings = {{"forward_delay", delay}, {"loss", "0"}},
          .metrics = {{"Position error", "mm", error}}};
}

// All signs equal: 2 of 2^5 assignments are as far from zero.
TEST(SignFlipTest, IsExactForFewDifferences) {
  EXPECT_DOUBLE_EQ(sign_flip_p({1.0, 2.0, 0.5, 3.0, 1.0}), 2.0 / 32.0);
  EXPECT_DOUBLE_EQ(sign_flip_p({1.0, -1.0}), 1.0);
  EXPECT_DOUBLE_EQ(sign_flip_p({}), 1.0);
}

// Of {1, 1, 1, -1} ten assignments have a sum of 2 or more in size; six have 0.
TEST(SignFlipTest, CountsEqualSums) {
  EXPECT_DOUBLE_EQ(sign_flip_p({1.0, 1.0, 1.0, -1.0}), 10.0 / 16.0);
}

// Against the normal approximation for 40 differences of which 26 are positive: z = 12 / sqrt(40),
// with half a step of 2 between sums, p = 0.082. Tolerance: three stds of 100 000 draws.
TEST(SignFlipTest, AgreesWithTheNormalApproximationForMany) {
  std::vector<double> differences(40, 1.0);
  for (std::size_t i = 0; i < 14; ++i) differences[i] = -1.0;
  EXPECT_NEAR(sign_flip_p(differences), 0.0807, 0.004);
  EXPECT_EQ(sign_flip_p(differences), sign_flip_p(differences));
}

TEST(HolmAdjustment, MultipliesByTheNumberOfRemainingTests) {
  const std::vector<double> adjusted = holm_adjusted({0.04, 0.01, 0.03});
  EXPECT_DOUBLE_EQ(adjusted[1], 0.03);
  EXPECT_DOUBLE_EQ(adjusted[2], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[0], 0.06);
}

TEST(RunComparison, PairsTheRunsOfARecordingUnderTwoSettings) {
  const Expected<RunComparison> comparison =
      compare_runs({run_of("a", "0.1", 1.0), run_of("b", "0.1", 2.0), run_of("c", "0.1", 9.0),
                    run_of("b", "0.3", 5.0), run_of("a", "0.3", 2.0)});
  ASSERT_TRUE(comparison) << comparison.error().to_string();
  EXPECT_EQ(comparison->settings,
            (std::vector<std::string>{"forward_delay=0.1", "forward_delay=0.3"}));
  ASSERT_EQ(comparison->differences.size(), 1U);
  const PairedDifference& difference = comparison->differences.front();
  EXPECT_EQ(difference.pairs, 2U);
  EXPECT_DOUBLE_EQ(difference.mean, 2.0);
  EXPECT_DOUBLE_EQ(difference.p, 0.5);
}

TEST(RunComparison, RefusesTheSameTwice) {
  const Expected<RunComparison> twice =
      compare_runs({run_of("a", "0.1", 1.0), run_of("a", "0.1", 1.0)});
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().to_string(), "a-0.1: is given twice; give each run once");
  EvaluatedRun copy = run_of("a", "0.1", 1.0);
  copy.run = "copy";
  const Expected<RunComparison> same = compare_runs({run_of("a", "0.1", 1.0), copy});
  ASSERT_FALSE(same);
  EXPECT_NE(same.error().message.find("same recording and the same settings as a-0.1"),
            std::string::npos);
}

}  // namespace
}  // namespace pcavr
