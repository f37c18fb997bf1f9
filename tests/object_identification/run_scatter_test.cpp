// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object_identification/run_scatter.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

std::vector<ParameterValue> runs_with(double scatter, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<ParameterValue> runs;
  for (std::size_t i = 0; i < count; ++i) {
    const double std = random.uniform(0.005, 0.02);
    runs.push_back({0.3 + scatter * random.normal() + std * random.normal(), std});
  }
  return runs;
}

TEST(RunScatter, IsWhatTheRunsDifferByBeyondTheirStds) {
  const RunScatter found = scatter_of_runs(runs_with(0.05, 400, 1));
  EXPECT_NEAR(found.scatter, 0.05, 0.006);
  EXPECT_NEAR(found.mean, 0.3, 3.0 * found.std);
  EXPECT_NEAR(found.std, 0.05 / std::sqrt(400.0), 4e-4);
}

TEST(RunScatter, CoversTheMeanOfFewRunsAsOftenAsItSays) {
  int inside = 0;
  constexpr int kTrials = 1000;
  for (int i = 0; i < kTrials; ++i) {
    const RunScatter found = scatter_of_runs(runs_with(0.03, 8, static_cast<std::uint64_t>(i) + 7));
    inside += std::abs(found.mean - 0.3) < found.std ? 1 : 0;
  }
  EXPECT_NEAR(inside, 0.66 * kTrials, 0.05 * kTrials);
}

TEST(RunScatter, IsNoneOfEqualRunsOrOfOne) {
  EXPECT_EQ(scatter_of_runs(std::vector<ParameterValue>(3, {2.0, 0.1})).scatter, 0.0);
  const RunScatter one = scatter_of_runs(std::vector<ParameterValue>{{2.0, 0.1}});
  EXPECT_EQ(one.mean, 2.0);
  EXPECT_NEAR(one.std, 0.1, 1e-12);
}

TEST(RunScatter, FindsTheRunThatContradictsTheOthers) {
  std::vector<ParameterValue> runs = runs_with(0.01, 6, 3);
  runs.push_back({0.4, 0.01});
  const std::vector<double> deviations = deviations_of_runs(runs, 0.02);
  EXPECT_GT(deviations.back(), 5.0);
  for (std::size_t i = 0; i + 1 < runs.size(); ++i) EXPECT_LT(std::abs(deviations[i]), 5.0);
}

TEST(RunScatter, AccusesNoneOfThree) {
  const std::vector<ParameterValue> runs{{0.3, 0.001}, {0.31, 0.001}, {0.6, 0.001}};
  EXPECT_EQ(deviations_of_runs(runs, 0.02), std::vector<double>(3, 0.0));
}

}  // namespace
}  // namespace pcavr
