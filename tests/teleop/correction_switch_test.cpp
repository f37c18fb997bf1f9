// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/correction_switch.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kTick = 0.002;
constexpr double kForceFloor = 0.3;  // [N]
constexpr double kRoundTrip = 0.4;   // [s]

CorrectionSwitch make_switch(const CorrectionSwitchOptions& options = {}) {
  return CorrectionSwitch(options, kForceFloor, kRoundTrip);
}

/// The first correction, if the comparison stays the same for a second from `from` on.
std::optional<std::pair<double, CorrectionCase>> first_correction(
    CorrectionSwitch& correction_switch, SiteComparison seen, double from, double traffic = 0.0) {
  for (double t = from; t < from + 1.0; t += kTick) {
    seen.t = t;
    if (const auto which = correction_switch.evaluate(seen, traffic)) return std::pair(t, *which);
  }
  return std::nullopt;
}

SiteComparison touched_by_both(double real, double rendered) {
  SiteComparison seen;
  seen.robot_touches = seen.operator_touches = true;
  seen.robot_force = real;
  seen.operator_force = rendered;
  return seen;
}

SiteComparison sliding_apart(double gap) {
  SiteComparison seen;
  seen.robot_slides = seen.operator_slides = true;
  seen.position_gap = gap;
  seen.position_std = 1e-4;
  return seen;
}

TEST(CorrectionSwitch, IgnoresForceErrorsBelowTheJnd) {
  CorrectionSwitch correction_switch = make_switch();
  EXPECT_FALSE(first_correction(correction_switch, touched_by_both(10.0, 10.9), 0.0));
}

TEST(CorrectionSwitch, Gives11IfTheForceErrorExceedsATenth) {
  CorrectionSwitch correction_switch = make_switch();
  const auto correction = first_correction(correction_switch, touched_by_both(10.0, 11.5), 0.0);
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->second, CorrectionCase::both_static_force);
  EXPECT_NEAR(correction->first, 0.040, 2.0 * kTick);
}

TEST(CorrectionSwitch, IgnoresTheSensorsNoise) {
  CorrectionSwitch correction_switch({}, 0.5, kRoundTrip);
  EXPECT_FALSE(first_correction(correction_switch, touched_by_both(1.0, 1.4), 0.0));
}

TEST(CorrectionSwitch, Gives12aIfOnlyTheOperatorTouches) {
  CorrectionSwitch correction_switch = make_switch();
  SiteComparison seen;
  seen.operator_touches = true;
  seen.operator_force = 2.0;
  EXPECT_EQ(first_correction(correction_switch, seen, 0.0)->second,
            CorrectionCase::touched_by_operator);
}

TEST(CorrectionSwitch, Gives12bIfOnlyTheRobotTouches) {
  CorrectionSwitch correction_switch = make_switch();
  SiteComparison seen;
  seen.robot_touches = true;
  seen.robot_force = 2.0;
  EXPECT_EQ(first_correction(correction_switch, seen, 0.0)->second,
            CorrectionCase::touched_by_robot);
}

TEST(CorrectionSwitch, Gives13IfBothSlideApart) {
  CorrectionSwitch correction_switch = make_switch();
  EXPECT_FALSE(first_correction(correction_switch, sliding_apart(0.0004), 0.0));
  EXPECT_EQ(first_correction(correction_switch, sliding_apart(0.0015), 2.0)->second,
            CorrectionCase::both_sliding);
}

TEST(CorrectionSwitch, Gives2IfThePhasesDiffer) {
  CorrectionSwitch correction_switch = make_switch();
  SiteComparison seen;
  seen.robot_slides = true;
  const auto correction = first_correction(correction_switch, seen, 0.0);
  EXPECT_EQ(correction->second, CorrectionCase::phases_differ);
  EXPECT_NEAR(correction->first, 0.060, 2.0 * kTick);
}

TEST(CorrectionSwitch, ToleratesAFlickeringPhase) {
  CorrectionSwitch correction_switch = make_switch();
  bool has_corrected = false;
  for (int i = 0; i < 100; ++i) {
    SiteComparison seen;
    seen.t = kTick * i;
    seen.operator_slides = i % 4 != 0;
    has_corrected = has_corrected || correction_switch.evaluate(seen, 0.0).has_value();
  }
  EXPECT_TRUE(has_corrected);
}

TEST(CorrectionSwitch, WaitsARoundTripForWhatIsInFlight) {
  CorrectionSwitch correction_switch = make_switch();
  const SiteComparison seen = sliding_apart(0.0015);
  const double sent = first_correction(correction_switch, seen, 0.0)->first;
  correction_switch.note_sent(CorrectionCase::both_sliding, sent);
  const auto again = first_correction(correction_switch, seen, sent + kTick);
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->first, sent + 0.46, 0.04);
}

TEST(CorrectionSwitch, DoesNotWaitIfTheErrorHasDoubled) {
  CorrectionSwitch correction_switch = make_switch();
  const double sent = first_correction(correction_switch, sliding_apart(0.0010), 0.0)->first;
  correction_switch.note_sent(CorrectionCase::both_sliding, sent);
  const auto again = first_correction(correction_switch, sliding_apart(0.0021), sent + kTick);
  ASSERT_TRUE(again);
  EXPECT_LT(again->first, sent + 0.1);
}

TEST(CorrectionSwitch, RaisesThresholdsOverTheByteBudget) {
  CorrectionSwitch correction_switch = make_switch();
  EXPECT_FALSE(first_correction(correction_switch, sliding_apart(0.0012), 0.0, 3.0));
  // But never more than the tolerance.
  EXPECT_TRUE(first_correction(correction_switch, sliding_apart(0.0032), 2.0, 3.0));
}

TEST(CorrectionSwitch, IgnoresUnknownPositions) {
  CorrectionSwitch correction_switch = make_switch();
  SiteComparison seen;
  seen.robot_slides = seen.operator_slides = true;
  EXPECT_FALSE(first_correction(correction_switch, seen, 0.0));
}

}  // namespace
}  // namespace pcavr
