// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/press_line.hpp"

#include <string>

#include <gtest/gtest.h>

#include "identification/plant.hpp"

namespace pcavr {
namespace {

Trial slow_line_push() {
  return run({}, {}, 2.0, 7, [](double t) { return 0.01 * (t - 0.3); });
}

TEST(PressLine, OfTheSameMaterialHasTheSlopeOfThePushAndFindsItsBreakaway) {
  const Plant plant;
  const Trial trial = slow_line_push();
  const Breakaway found = find_breakaway(trial.series());
  ASSERT_TRUE(found.is_found);
  const PressLine line =
      compare_with_press(trial.series(), found, {plant.stiffness, plant.damping, plant.exponent});
  ASSERT_TRUE(line.ratio.is_excited);
  RecordProperty("ratio", std::to_string(line.ratio.value));
  // The bristles yield with the load: some per cent less steep.
  EXPECT_NEAR(line.ratio.value, 1.0, 0.05);
  ASSERT_TRUE(line.t_mutation.has_value());
  EXPECT_NEAR(line.force, trial.peak_before_slide, 0.15 * trial.peak_before_slide);
}

TEST(PressLine, OfAPress20PercentTooStiffLeavesThePushEarly) {
  const Plant plant;
  const Trial trial = slow_line_push();
  const Breakaway found = find_breakaway(trial.series());
  const PressLine right =
      compare_with_press(trial.series(), found, {plant.stiffness, plant.damping, plant.exponent});
  const PressLine stiff = compare_with_press(
      trial.series(), found, {1.2 * plant.stiffness, plant.damping, plant.exponent});
  ASSERT_TRUE(stiff.ratio.is_excited);
  EXPECT_NEAR(stiff.ratio.value, right.ratio.value / 1.2, 0.03);
  ASSERT_TRUE(stiff.t_mutation.has_value());
  RecordProperty("force_over_limit", std::to_string(stiff.force / trial.peak_before_slide));
  // Why the push's own line decides, and the press's is only its check.
  EXPECT_LT(stiff.force, 0.9 * trial.peak_before_slide);
}

TEST(PressLine, OfAPushThatDidNotBreakLooseIsUnknown) {
  EXPECT_FALSE(compare_with_press({}, {}, {2e4, 0.0, 1.5}).ratio.is_excited);
}

}  // namespace
}  // namespace pcavr
