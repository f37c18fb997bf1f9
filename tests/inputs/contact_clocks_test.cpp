// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/contact_clocks.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

struct Clock {
  double step = 0.0, step_at = 0.0;  ///< [s]
  double drift = 0.0;
};

/// Of contacts every 5 s, with errors of these stds.
std::vector<ContactDelay> delays_of(int contacts, const Clock& clock, double std, Random& random) {
  std::vector<ContactDelay> delays;
  for (int i = 0; i < contacts; ++i) {
    const double t = 5.0 * i, own = std * random.uniform(0.5, 1.5);
    const double delay = 0.02 + (t > clock.step_at ? clock.step : 0.0) + clock.drift * t;
    delays.push_back({t, delay + own * random.normal(), own});
  }
  return delays;
}

TEST(ContactClocks, TellAStepFromADriftAndFromNeither) {
  Random random(1);
  for (int run = 0; run < 50; ++run) {
    const DelayChange none = find_delay_change(delays_of(12, {}, 0.01, random));
    EXPECT_FALSE(none.step || none.drift) << run;
    const DelayChange set =
        find_delay_change(delays_of(12, {.step = -0.1, .step_at = 22.0}, 0.01, random));
    ASSERT_TRUE(set.step) << run;
    EXPECT_NEAR(set.step->size, -0.1, 4.5 * set.step->std);
    EXPECT_LT(set.step->after, 22.0);
    EXPECT_GT(set.step->before, 22.0);
    const DelayChange fast = find_delay_change(delays_of(80, {.drift = 2e-4}, 0.01, random));
    ASSERT_TRUE(fast.drift) << run;
    EXPECT_NEAR(fast.drift->rate, 2e-4, 4.5 * fast.drift->std);
  }
}

TEST(ContactClocks, StateStdsThatHoldOfStepsAndOfDrifts) {
  Random random(2);
  int of_step = 0, of_drift = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    const DelayChange set =
        find_delay_change(delays_of(12, {.step = 0.15, .step_at = 22.0}, 0.01, random));
    const auto drift = fit_delay_drift(delays_of(20, {.drift = 5e-5}, 0.01, random));
    ASSERT_TRUE(set.step);
    ASSERT_TRUE(drift);
    of_step += std::abs(set.step->size - 0.15) < set.step->std ? 1 : 0;
    of_drift += std::abs(drift->rate - 5e-5) < drift->std ? 1 : 0;
  }
  std::printf("  within one std: steps %d of %d, drifts %d of %d\n", of_step, kRuns, of_drift,
              kRuns);
  for (const int within : {of_step, of_drift}) {
    EXPECT_GE(within, 0.60 * kRuns);
    EXPECT_LE(within, 0.82 * kRuns);
  }
}

TEST(ContactClocks, SayNothingOfOneContact) {
  const std::vector<ContactDelay> one{{.t = 1.0, .delay = 0.1, .std = 0.001}};
  const DelayChange change = find_delay_change(one);
  EXPECT_FALSE(change.step || change.drift);
}

}  // namespace
}  // namespace pcavr
