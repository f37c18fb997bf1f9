// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/signals.hpp"

#include "support/heap_counter.hpp"

namespace pcavr {
namespace {

TEST(Steps, DoNotAllocate) {
  for (const EstimationMethod method : {EstimationMethod::block, EstimationMethod::exponential,
                                        EstimationMethod::adaptive, EstimationMethod::averaged}) {
    EstimatorOptions<3> options;
    options.method = method;
    ParameterEstimator<3> estimator(options);
    CausalFilter filter(0.02, 500.0, 0.1);
    const long before = heap_allocations;
    double used = 0.0;
    for (int i = 0; i < 500; ++i) {
      const double t = 0.002 * i;
      const auto out = filter.step(t, std::sin(9.0 * t), std::cos(t));
      if (!out) continue;
      estimator.step({out->acceleration, out->speed, out->position}, out->force);
      used += estimator.estimate().samples;
    }
    EXPECT_EQ(heap_allocations, before);
    EXPECT_GT(used, 0.0);
  }
}

}  // namespace
}  // namespace pcavr
