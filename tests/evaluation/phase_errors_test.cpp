// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/evaluation/phase_errors.hpp"

#include <gtest/gtest.h>

#include "results/evaluation/time_nodes.hpp"
#include "run_samples.hpp"

namespace pcavr {
namespace {

/// Sums of a few doubles of about a second.
constexpr double kRounding = 1e-9;

TEST(PhaseTimelines, GiveThePhaseAtATime) {
  const PhaseTimeline phases = one_push();
  EXPECT_EQ(phase_at(phases, at(0.0)), Phase::free);
  EXPECT_EQ(phase_at(phases, at(1.1999)), Phase::static_contact);
  EXPECT_EQ(phase_at(phases, at(1.2)), Phase::critical);
  EXPECT_EQ(phase_at(phases, at(100.0)), Phase::free);
  EXPECT_FALSE(phase_at(phases, at(-0.1)).has_value());
  EXPECT_FALSE(phase_at({}, at(0.0)).has_value());
}

TEST(PhaseTimelines, ParseTheNamesThatTheyWrite) {
  for (const Phase phase : kPhases) EXPECT_EQ(phase_from_string(to_string(phase)), phase);
  EXPECT_FALSE(phase_from_string("Static").has_value());
}

TEST(PhaseEvents, AreOneForEachChange) {
  const std::vector<TimedEvent> events = events_of(one_push());
  ASSERT_EQ(events.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(events[i].event, kEvents.at(i));
  EXPECT_EQ(events[3].stamp, at(2.0));
}

TEST(PhaseEvents, OfABodyThatSlidesAwayAreStopAndLeaveAtOneStamp) {
  const std::vector<TimedEvent> events =
      events_of(timeline({{0.0, Phase::sliding}, {1.0, Phase::free}}));
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].event, PhaseEvent::stop);
  EXPECT_EQ(events[1].event, PhaseEvent::leave);
}

TEST(PhaseErrors, OfARecordAgainstItselfAreNone) {
  const PhaseErrors errors = phase_errors(one_push(), one_push(), at(4.0));
  EXPECT_EQ(event_errors(errors), std::vector<double>(5, 0.0));
  EXPECT_EQ(count_missed(errors) + count_surplus(errors), 0U);
  EXPECT_EQ(agreement(errors, false), 1.0);
  EXPECT_EQ(agreement(errors, true), 1.0);
}

TEST(PhaseErrors, OfALateRecordAreItsDelay) {
  const PhaseErrors errors = phase_errors(one_push(), one_push(0.02), at(4.0));
  const std::vector<double> seconds = event_errors(errors);
  ASSERT_EQ(seconds.size(), 5U);
  for (const double error : seconds) EXPECT_NEAR(error, 0.02, kRounding);
  // Five transitions of 20 ms in 4 s; of the 1.52 s in which either is in contact, the same five.
  EXPECT_NEAR(agreement(errors, false), 1.0 - 0.1 / 4.0, kRounding);
  EXPECT_NEAR(agreement(errors, true), 1.0 - 0.1 / 1.52, kRounding);
  EXPECT_NEAR(errors.seconds[0][1], 0.02, kRounding);  // true free, estimated static
  EXPECT_EQ(errors.seconds[0][3], 0.0);
  EXPECT_NEAR(errors.seconds[1][0], 0.02, kRounding);  // true static, estimated free
  EXPECT_NEAR(errors.seconds[3][2], 0.02, kRounding);  // true sliding, estimated critical
}

TEST(PhaseErrors, CountAnEventFartherThanHalfASecondAsMissedAndSurplus) {
  const PhaseErrors errors = phase_errors(one_push(), one_push(0.6), at(4.0));
  EXPECT_EQ(count_missed(errors, PhaseEvent::sliding), 1U);
  EXPECT_EQ(count_surplus(errors, PhaseEvent::sliding), 1U);
  EXPECT_TRUE(event_errors(errors, PhaseEvent::sliding).empty());
}

TEST(PhaseErrors, MatchTheNearestOfSeveral) {
  const PhaseTimeline chattering = timeline({{0.0, Phase::free},
                                             {0.9, Phase::static_contact},
                                             {0.95, Phase::free},
                                             {1.01, Phase::static_contact},
                                             {2.0, Phase::free}});
  const PhaseTimeline truth =
      timeline({{0.0, Phase::free}, {1.0, Phase::static_contact}, {2.0, Phase::free}});
  const PhaseErrors errors = phase_errors(truth, chattering, at(3.0));
  const std::vector<double> contact = event_errors(errors, PhaseEvent::contact);
  ASSERT_EQ(contact.size(), 1U);
  EXPECT_NEAR(contact[0], 0.01, kRounding);
  EXPECT_EQ(count_surplus(errors, PhaseEvent::contact), 1U);
  EXPECT_EQ(count_surplus(errors, PhaseEvent::leave), 1U);
  EXPECT_EQ(count_missed(errors), 0U);
}

TEST(PhaseErrors, MatchASlideThatSkipsCritical) {
  const PhaseTimeline abrupt = timeline({{0.0, Phase::free},
                                         {1.0, Phase::static_contact},
                                         {1.51, Phase::sliding},
                                         {2.0, Phase::static_contact},
                                         {2.5, Phase::free}});
  const PhaseErrors errors = phase_errors(one_push(), abrupt, at(4.0));
  EXPECT_EQ(count_missed(errors, PhaseEvent::critical), 1U);
  EXPECT_EQ(count_missed(errors), 1U);
  EXPECT_NEAR(event_errors(errors, PhaseEvent::sliding).at(0), 0.01, kRounding);
}

TEST(PhaseErrors, ExcludeEventsOutsideTheCommonTimeSpan) {
  // The estimate begins after the contact and ends before the object is left.
  const PhaseTimeline late = timeline({{1.1, Phase::static_contact}, {1.5, Phase::sliding}});
  const PhaseErrors errors = phase_errors(one_push(), late, at(1.8));
  EXPECT_EQ(count_missed(errors, PhaseEvent::contact), 0U);
  EXPECT_EQ(count_missed(errors, PhaseEvent::critical), 1U);
  EXPECT_EQ(count_missed(errors, PhaseEvent::stop), 0U);
  double total = 0.0;
  for (const auto& row : errors.seconds) {
    for (const double seconds : row) total += seconds;
  }
  EXPECT_NEAR(total, 0.7, kRounding);
}

TEST(PhaseErrors, OfABodyWithoutContactAreNone) {
  const PhaseTimeline without_contact = timeline({{0.0, Phase::free}});
  const PhaseErrors errors = phase_errors(without_contact, without_contact, at(4.0));
  EXPECT_TRUE(errors.events.empty());
  EXPECT_EQ(agreement(errors, false), 1.0);
  EXPECT_EQ(agreement(errors, true), 0.0);  // there is no such time
  EXPECT_TRUE(phase_errors({}, without_contact, at(4.0)).events.empty());
}

TEST(PhaseErrors, ArePooledOverObjects) {
  const PhaseErrors sum = merged({phase_errors(one_push(), one_push(0.02), at(4.0)),
                                  phase_errors(one_push(), one_push(), at(4.0))});
  EXPECT_EQ(event_errors(sum).size(), 10U);
  EXPECT_NEAR(sum.seconds[0][0], 2.48 + 2.5, kRounding);
}

TEST(TimeNodes, AreNumberedPushByPushOverAllObjects) {
  PhaseTimeline later = one_push();
  for (PhaseChange& change : later) change.stamp = change.stamp + std::chrono::seconds(3);
  const std::vector<TimeNode> nodes = time_nodes({{"a_second", later}, {"first", one_push()}});
  ASSERT_EQ(nodes.size(), 10U);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(nodes[static_cast<std::size_t>(i)].number, i + 1);
  EXPECT_EQ(nodes[0].object, "first");
  EXPECT_EQ(nodes[5].object, "a_second");
  EXPECT_EQ(nodes[7].event.event, PhaseEvent::sliding);
  EXPECT_EQ(nodes[7].event.stamp, at(4.5));
}

TEST(TimeNodes, OfASlideThatSticksHaveItsFirstStartAndItsLastStop) {
  const std::vector<TimeNode> nodes = time_nodes({{"box", timeline({{0.0, Phase::free},
                                                                    {1.0, Phase::static_contact},
                                                                    {1.5, Phase::sliding},
                                                                    {1.6, Phase::static_contact},
                                                                    {1.7, Phase::sliding},
                                                                    {2.0, Phase::static_contact},
                                                                    {2.5, Phase::free}})}});
  ASSERT_EQ(nodes.size(), 4U);
  EXPECT_EQ(nodes[1].number, 3);  // there was no critical
  EXPECT_EQ(nodes[1].event.stamp, at(1.5));
  EXPECT_EQ(nodes[2].event.stamp, at(2.0));
}

TEST(TimeNodes, OfABodyWithoutContactAreNone) {
  EXPECT_TRUE(time_nodes({{"box", timeline({{0.0, Phase::free}})}}).empty());
  // A record that begins in the middle of a push has no contact event.
  EXPECT_TRUE(
      time_nodes({{"box", timeline({{0.0, Phase::static_contact}, {1.0, Phase::free}})}}).empty());
}

}  // namespace
}  // namespace pcavr
