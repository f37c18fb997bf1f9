// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/correction_switch.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kTick = 0.002;

/// When the switch first speaks, if the same is seen from `from` on for a second.
std::optional<std::pair<double, CorrectionCase>> first_word(CorrectionSwitch& gate,
                                                            SiteComparison seen, double from,
                                                            double traffic = 0.0) {
  for (double t = from; t < from + 1.0; t += kTick) {
    seen.t = t;
    if (const auto which = gate.judge(seen, traffic)) return std::pair(t, *which);
  }
  return std::nullopt;
}

SiteComparison touched_by_both(double real, double felt) {
  SiteComparison seen;
  seen.robot_touches = seen.operator_touches = true;
  seen.robot_force = real;
  seen.operator_force = felt;
  return seen;
}

SiteComparison sliding_apart(double gap) {
  SiteComparison seen;
  seen.robot_slides = seen.operator_slides = true;
  seen.position_gap = gap;
  seen.position_sigma = 1e-4;
  return seen;
}

TEST(CorrectionSwitch, LetsAForcePassThatNoHandTellsApart) {
  CorrectionSwitch gate({});
  EXPECT_FALSE(first_word(gate, touched_by_both(10.0, 10.9), 0.0));
}

TEST(CorrectionSwitch, Tells11WhereTheForceIsOffByMoreThanATenth) {
  CorrectionSwitch gate({});
  const auto word = first_word(gate, touched_by_both(10.0, 11.5), 0.0);
  ASSERT_TRUE(word);
  EXPECT_EQ(word->second, CorrectionCase::both_static_force);
  EXPECT_NEAR(word->first, 0.040, 2.0 * kTick);
}

TEST(CorrectionSwitch, TakesTheSensorsNoiseForNoDifference) {
  CorrectionSwitch gate({.force_floor = 0.5});
  EXPECT_FALSE(first_word(gate, touched_by_both(1.0, 1.4), 0.0));
}

TEST(CorrectionSwitch, Tells12aWhereTheOperatorAloneTouches) {
  CorrectionSwitch gate({});
  SiteComparison seen;
  seen.operator_touches = true;
  seen.operator_force = 2.0;
  EXPECT_EQ(first_word(gate, seen, 0.0)->second, CorrectionCase::touched_by_operator);
}

TEST(CorrectionSwitch, Tells12bWhereTheRobotAloneTouches) {
  CorrectionSwitch gate({});
  SiteComparison seen;
  seen.robot_touches = true;
  seen.robot_force = 2.0;
  EXPECT_EQ(first_word(gate, seen, 0.0)->second, CorrectionCase::touched_by_robot);
}

TEST(CorrectionSwitch, Tells13WhereBothSlideApart) {
  CorrectionSwitch gate({});
  EXPECT_FALSE(first_word(gate, sliding_apart(0.0004), 0.0));
  EXPECT_EQ(first_word(gate, sliding_apart(0.0015), 2.0)->second, CorrectionCase::both_sliding);
}

TEST(CorrectionSwitch, Tells2WhereThePhasesDiffer) {
  CorrectionSwitch gate({});
  SiteComparison seen;
  seen.robot_slides = true;
  const auto word = first_word(gate, seen, 0.0);
  EXPECT_EQ(word->second, CorrectionCase::phases_differ);
  EXPECT_NEAR(word->first, 0.060, 2.0 * kTick);
}

TEST(CorrectionSwitch, BearsAFlickerOfThePhase) {
  CorrectionSwitch gate({});
  bool has_spoken = false;
  for (int i = 0; i < 100; ++i) {
    SiteComparison seen;
    seen.t = kTick * i;
    seen.operator_slides = i % 4 != 0;
    has_spoken = has_spoken || gate.judge(seen, 0.0).has_value();
  }
  EXPECT_TRUE(has_spoken);
}

TEST(CorrectionSwitch, WaitsARoundTripForWhatIsOnItsWay) {
  CorrectionSwitch gate({.round_trip = 0.4});
  const SiteComparison seen = sliding_apart(0.0015);
  const double sent = first_word(gate, seen, 0.0)->first;
  gate.note_sent(CorrectionCase::both_sliding, sent);
  const auto again = first_word(gate, seen, sent + kTick);
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->first, sent + 0.46, 0.04);
}

TEST(CorrectionSwitch, DoesNotWaitWhereTheDifferenceHasDoubled) {
  CorrectionSwitch gate({.round_trip = 0.4});
  const double sent = first_word(gate, sliding_apart(0.0010), 0.0)->first;
  gate.note_sent(CorrectionCase::both_sliding, sent);
  const auto again = first_word(gate, sliding_apart(0.0021), sent + kTick);
  ASSERT_TRUE(again);
  EXPECT_LT(again->first, sent + 0.1);
}

TEST(CorrectionSwitch, BearsMoreWhereTheTrafficIsOverItsBudget) {
  CorrectionSwitch gate({});
  EXPECT_FALSE(first_word(gate, sliding_apart(0.0012), 0.0, 3.0));
  // But never more than the tolerance.
  EXPECT_TRUE(first_word(gate, sliding_apart(0.0032), 2.0, 3.0));
}

TEST(CorrectionSwitch, SaysNothingOfAPlaceThatItDoesNotKnow) {
  CorrectionSwitch gate({});
  SiteComparison seen;
  seen.robot_slides = seen.operator_slides = true;
  EXPECT_FALSE(first_word(gate, seen, 0.0));
}

}  // namespace
}  // namespace pcavr
