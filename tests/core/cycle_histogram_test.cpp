// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/cycle_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

/// The smallest of the sorted durations that at least `per_mille` of all do not exceed.
double exact_quantile(const std::vector<double>& sorted, std::size_t per_mille) {
  return sorted[(sorted.size() * per_mille + 999) / 1000 - 1];
}

/// Durations within the range of the histogram's bins, 0.25 us to 0.22 s [s].
using DrawDuration = double (*)(Random&);
const std::vector<std::pair<const char*, DrawDuration>> kDistributions = {
    {"uniform", [](Random& random) { return random.uniform(1e-6, 1e-3); }},
    {"log-uniform", [](Random& random) { return 3e-7 * std::exp2(random.uniform(0.0, 19.0)); }},
    {"exponential", [](Random& random) { return 2e-6 - 3e-5 * std::log1p(-random.uniform()); }},
    {"log-normal", [](Random& random) { return 4e-5 * std::exp(0.7 * random.normal()); }},
    {"a hundredth is delayed",
     [](Random& random) {
       const double usual = 2e-5 * random.uniform(0.9, 1.1);
       return random.below(100) == 0 ? usual + random.uniform(1e-3, 5e-3) : usual;
     }},
    {"constant", [](Random&) { return 1.3e-5; }},
    {"just above a bin's end", [](Random&) { return 0.25e-6 * 64.0 * (1.0 + 1e-9); }},
    {"on a bin's end", [](Random&) { return 0.25e-6 * 64.0; }}};

TEST(CycleHistogram, QuantilesAreExactToHalfABin) {
  // A bin is an eighth of an octave: half of it is a factor of 2^(1/16). Rounding adds 1e-12.
  const double half_bin = std::exp2(1.0 / 16.0) * (1.0 + 1e-12);
  const auto expect_within_half_a_bin = [&](double value, double exact) {
    EXPECT_LE(value, exact * half_bin);
    EXPECT_GE(value, exact / half_bin);
  };
  for (const auto& [name, draw] : kDistributions) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(testing::Message() << name << ", seed " << seed);
      Random random(seed);
      CycleHistogram histogram(100);
      std::vector<double> all;
      for (int i = 0; i < 2000; ++i) {
        all.push_back(draw(random));
        histogram.add(all.back());
      }
      std::vector<double> newest(all.end() - 1000, all.end());
      for (auto [times, exact] :
           {std::pair(histogram.times(), newest), {histogram.times_of_all(), all}}) {
        std::sort(exact.begin(), exact.end());
        expect_within_half_a_bin(times.median, exact_quantile(exact, 500));
        expect_within_half_a_bin(times.p99, exact_quantile(exact, 990));
        expect_within_half_a_bin(times.p999, exact_quantile(exact, 999));
        EXPECT_EQ(times.longest, exact.back());
      }
    }
  }
}

TEST(CycleHistogram, QuantilesAreWithoutBias) {
  // Durations uniform in the logarithm are uniform within a bin: the error of its middle is uniform
  // over +-1/16 octave, with mean zero and std 1/16/sqrt(3). Bound: 4 std of the mean error.
  constexpr int kSeeds = 400;
  const double bound = 4.0 / 16.0 / std::sqrt(3.0 * kSeeds);
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Random random(seed);
    CycleHistogram histogram(1);
    std::vector<double> durations;
    for (int i = 0; i < 10; ++i) {
      durations.push_back(1e-6 * std::exp2(random.uniform(0.0, 10.0)));
      histogram.add(durations.back());
    }
    std::sort(durations.begin(), durations.end());
    sum += std::log2(histogram.times().median / exact_quantile(durations, 500));
  }
  EXPECT_NEAR(sum / kSeeds, 0.0, bound);
}

TEST(CycleHistogram, QuantilesBeyondTheBinsAreTheLongest) {
  CycleHistogram histogram(100);
  for (int i = 0; i < 1000; ++i) histogram.add(1.0 + 0.001 * i);
  EXPECT_EQ(histogram.times().median, histogram.times().longest);
}

TEST(CycleHistogram, DropsWhatIsOlderThanTenSlices) {
  CycleHistogram histogram(10);
  histogram.add(0.5);
  for (int i = 0; i < 99; ++i) histogram.add(1e-5);
  EXPECT_EQ(histogram.times().longest, 0.5);
  for (int i = 0; i < 10; ++i) histogram.add(1e-5);
  EXPECT_EQ(histogram.times().longest, 1e-5);
}

TEST(CycleHistogram, AcceptsAnyNumber) {
  CycleHistogram histogram(1);
  for (const double duration : {0.0, -1.0, std::nan(""), 1e9}) histogram.add(duration);
  EXPECT_EQ(histogram.times().longest, 1e9);
}

}  // namespace
}  // namespace pcavr
