// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/correction_switch.hpp"

#include <string>

#include <gtest/gtest.h>

#include "teleoperation/teleop/message.hpp"
#include "teleoperation/teleop/sent_parameters.hpp"

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

/// Sends a correction of case 1.3 for a gap of 1.5 mm, and has it received half a second later;
/// the gap is `after` from then on, `share_along` of it along the push. Returns whether it had no
/// effect.
bool had_no_effect(CorrectionSwitch& correction_switch, double after, bool is_received = true,
                   double share_along = -0.9) {
  const double sent = first_correction(correction_switch, sliding_apart(0.0015), 0.0)->first;
  correction_switch.note_sent(CorrectionCase::both_sliding, sent, 7);
  for (double t = sent; t < sent + 1.0; t += kTick) {
    SiteComparison seen = sliding_apart(t < sent + 0.5 ? 0.0015 : after);
    seen.push_gap = share_along * *seen.position_gap;
    seen.t = t;
    if (is_received && t >= sent + 0.5) correction_switch.note_received(7);
    (void)correction_switch.evaluate(seen, 0.0);
  }
  return correction_switch.had_no_effect(CorrectionCase::both_sliding);
}

TEST(CorrectionSwitch, FindsThatACorrectionWhileSlidingHadNoEffect) {
  CorrectionSwitch same = make_switch();
  EXPECT_TRUE(had_no_effect(same, 0.0014));
  EXPECT_FALSE(same.had_no_effect(CorrectionCase::phases_differ));
  CorrectionSwitch corrected = make_switch();
  EXPECT_FALSE(had_no_effect(corrected, 0.0002));
  CorrectionSwitch grown = make_switch();
  EXPECT_FALSE(had_no_effect(grown, 0.0031));
  CorrectionSwitch lost = make_switch();
  EXPECT_FALSE(had_no_effect(lost, 0.0014, false));
  CorrectionSwitch across = make_switch();
  EXPECT_FALSE(had_no_effect(across, 0.0014, true, 0.1));
}

TEST(CorrectionSwitch, ForgetsTheEffectWhenTheSlideEnds) {
  CorrectionSwitch correction_switch = make_switch();
  ASSERT_TRUE(had_no_effect(correction_switch, 0.0014));
  SiteComparison at_rest = touched_by_both(5.0, 5.0);
  at_rest.t = 3.0;
  (void)correction_switch.evaluate(at_rest, 0.0);
  EXPECT_FALSE(correction_switch.had_no_effect(CorrectionCase::both_sliding));
}

/// Content of a correction of case 1.3 after both groups of parameters have changed, where the
/// operator's force is off by the given share.
std::string content_while_sliding(double force_gap, bool parameters_by_force) {
  ParameterDifference changed;
  changed.has_contact = changed.has_friction = true;
  changed.contact.contact_stiffness = ParameterValue{1e4};
  changed.friction.sliding_friction_coefficient = ParameterValue{0.3};
  MessageOptions options;
  options.parameters_by_force = parameters_by_force;
  SiteComparison seen = sliding_apart(0.0035);
  seen.robot_force = 10.0;
  seen.operator_force = 10.0 * (1.0 + force_gap);
  CorrectionMessage message;
  message.parameters = parameters_to_send(changed, CorrectionCase::both_sliding,
                                          make_switch().forces_agree(seen), options);
  return describe(message);
}

TEST(ParametersToSend, AreAllThatChangedWhileSlidingWithAForceGapOf5Percent) {
  EXPECT_EQ(content_while_sliding(0.05, false), "contact parameters+friction parameters");
  EXPECT_EQ(content_while_sliding(0.05, true), "friction parameters");
}

TEST(ParametersToSend, AreAllThatChangedWhileSlidingWithAForceGapOf20Percent) {
  EXPECT_EQ(content_while_sliding(0.20, false), "contact parameters+friction parameters");
  EXPECT_EQ(content_while_sliding(0.20, true), "contact parameters");
}

TEST(CorrectionSwitch, RaisesThresholdsOverTheByteBudget) {
  CorrectionSwitch correction_switch = make_switch();
  EXPECT_FALSE(first_correction(correction_switch, sliding_apart(0.0012), 0.0, 3.0));
  // But never more than the tolerance.
  EXPECT_TRUE(first_correction(correction_switch, sliding_apart(0.0032), 2.0, 3.0));
}

/// Both slide at the same place, with forces that differ.
SiteComparison sliding_with_forces(double real, double rendered) {
  SiteComparison seen = touched_by_both(real, rendered);
  seen.robot_slides = seen.operator_slides = true;
  seen.position_gap = 0.0001;
  seen.position_std = 1e-4;
  return seen;
}

TEST(CorrectionSwitch, Gives13IfBothSlideAtOnePlaceWithAnotherForce) {
  CorrectionSwitch correction_switch = make_switch();
  EXPECT_FALSE(first_correction(correction_switch, sliding_with_forces(15.0, 16.0), 0.0));
  const auto correction = first_correction(correction_switch, sliding_with_forces(15.0, 19.0), 2.0);
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->second, CorrectionCase::both_sliding);
  EXPECT_TRUE(correction_switch.is_sliding_force());
  EXPECT_NEAR(correction->first, 2.040, 2.0 * kTick);
}

TEST(CorrectionSwitch, FindsAPositionWhileNothingIsToBeSentForTheForce) {
  CorrectionSwitch correction_switch = make_switch();
  SiteComparison seen = sliding_with_forces(15.0, 19.0);
  const double t = first_correction(correction_switch, seen, 0.0)->first;
  correction_switch.note_nothing_to_send(CorrectionCase::both_sliding, t);
  seen.position_gap = 0.0015;
  const auto correction = first_correction(correction_switch, seen, t + kTick);
  ASSERT_TRUE(correction);
  EXPECT_FALSE(correction_switch.is_sliding_force());
  EXPECT_LT(correction->first, t + 0.04);
}

TEST(CorrectionSwitch, WaitsForAPositionInFlightBeforeItFindsTheForce) {
  CorrectionSwitch correction_switch = make_switch();
  const double sent = first_correction(correction_switch, sliding_apart(0.0015), 0.0)->first;
  correction_switch.note_sent(CorrectionCase::both_sliding, sent);
  const auto again =
      first_correction(correction_switch, sliding_with_forces(15.0, 19.0), sent + kTick);
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->first, sent + 0.46, 0.04);
}

TEST(CorrectionSwitch, IgnoresUnknownPositions) {
  CorrectionSwitch correction_switch = make_switch();
  SiteComparison seen;
  seen.robot_slides = seen.operator_slides = true;
  EXPECT_FALSE(first_correction(correction_switch, seen, 0.0));
}

}  // namespace
}  // namespace pcavr
