// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/evaluation/correction_metrics.hpp"

#include <gtest/gtest.h>

#include "run_samples.hpp"

namespace pcavr {
namespace {

constexpr Duration kRoundTrip = std::chrono::milliseconds(400);
/// Stamps are exact to a nanosecond, seconds to some 1e-16.
constexpr double kRounding = 1e-9;

RunCorrection a_correction(double t, bool is_lost = false) {
  return {.stamp = at(t),
          .object = "box",
          .which = "2",
          .what = {"position", "friction parameters"},
          .is_lost = is_lost,
          .bytes = 100};
}

TEST(CorrectionCounts, AreByCaseAndByContent) {
  RunCorrection contact = a_correction(2.0);
  contact.which = "1.1";
  contact.what = {"contact parameters"};
  const CorrectionCounts counts =
      count_corrections({a_correction(1.0), a_correction(1.5, true), contact});
  EXPECT_EQ(counts.count, 3U);
  EXPECT_EQ(counts.lost, 1U);
  EXPECT_EQ(counts.bytes, 300U);
  EXPECT_EQ(counts.by_case.at("2"), 2U);
  EXPECT_EQ(counts.by_case.at("1.1"), 1U);
  EXPECT_EQ(counts.by_what.at("position"), 2U);
  EXPECT_EQ(counts.by_what.at("contact parameters"), 1U);
  EXPECT_EQ(count_corrections({}).count, 0U);
}

TEST(FirstParameters, AreThoseThatArriveFirstAndAreNotLost) {
  RunCorrection position = a_correction(0.5);
  position.what = {"position"};
  RunCorrection other = a_correction(0.6);
  other.object = "ball";
  const std::vector<RunCorrection> corrections = {position, other, a_correction(1.0, true),
                                                  a_correction(2.0), a_correction(3.0)};
  EXPECT_EQ(first_parameters("box", corrections, kRoundTrip), at(2.4));
  EXPECT_FALSE(first_parameters("box", {position}, kRoundTrip).has_value());
}

TEST(CorrectionEffects, LastUntilTheErrorIsWithinTolerance) {
  const auto errors = errors_every_tenth({0.01, 0.01, 0.01, 0.008, 0.004, 0.002, 0.001});
  const CorrectionEffect effect = effect_of(a_correction(0.1), errors);
  EXPECT_EQ(effect.initial_error, 0.01);
  ASSERT_TRUE(effect.seconds_to_tolerance.has_value());
  EXPECT_NEAR(*effect.seconds_to_tolerance, 0.4, kRounding);
}

TEST(CorrectionEffects, AreNoneWhereTheErrorIsWithinTolerance) {
  const CorrectionEffect effect = effect_of(a_correction(0.0), errors_every_tenth({0.001, 0.01}));
  EXPECT_EQ(effect.initial_error, 0.001);
  EXPECT_EQ(effect.seconds_to_tolerance, 0.0);
}

TEST(CorrectionEffects, AreUnknownAfterTheLastPoseAndNeverEndOutsideTolerance) {
  EXPECT_FALSE(effect_of(a_correction(5.0), errors_every_tenth({0.01})).initial_error.has_value());
  const CorrectionEffect effect = effect_of(a_correction(0.0), errors_every_tenth({0.01, 0.02}));
  EXPECT_EQ(effect.initial_error, 0.01);
  EXPECT_FALSE(effect.seconds_to_tolerance.has_value());
}

TEST(Settling, CountsCorrectionsThatHaveArrived) {
  // The error is outside until the first correction's arrival at 0.4 s, and again from 0.8 to 1.1
  // s, until the correction for 0.6 s has arrived.
  const auto errors = errors_every_tenth({0.01, 0.01, 0.01, 0.01, 0.006, 0.002, 0.001, 0.002, 0.004,
                                          0.005, 0.006, 0.004, 0.001, 0.001});
  const Settling settling =
      settling_of("box", {a_correction(0.0), a_correction(0.6)}, errors, kRoundTrip);
  EXPECT_FALSE(settling.starts_in_tolerance);
  EXPECT_EQ(settling.corrections_to_tolerance, 1U);
  ASSERT_TRUE(settling.seconds_to_tolerance.has_value());
  EXPECT_NEAR(*settling.seconds_to_tolerance, 0.5, kRounding);
  EXPECT_EQ(settling.corrections_until_settled, 2U);
}

TEST(Settling, ExcludesLostCorrectionsAndThoseOfOtherObjects) {
  const auto errors = errors_every_tenth({0.01, 0.01, 0.01, 0.01, 0.01, 0.001});
  const Settling settling = settling_of("box", {a_correction(0.0, true)}, errors, kRoundTrip);
  EXPECT_EQ(settling.corrections_to_tolerance, 0U);
  EXPECT_EQ(settling_of("ball", {a_correction(0.0)}, errors, kRoundTrip).corrections_to_tolerance,
            0U);
}

TEST(Settling, NeedsNoCorrectionWithinTolerance) {
  const Settling settling = settling_of("box", {}, errors_every_tenth({0.001, 0.002}), kRoundTrip);
  EXPECT_TRUE(settling.starts_in_tolerance);
  EXPECT_EQ(settling.corrections_until_settled, 0U);
}

TEST(Settling, IsNeverReachedWhereTheLastErrorIsOutsideTolerance) {
  const Settling settling = settling_of("box", {}, errors_every_tenth({0.001, 0.01}), kRoundTrip);
  EXPECT_FALSE(settling.corrections_until_settled.has_value());
  EXPECT_FALSE(settling_of("box", {}, errors_every_tenth({0.01}), kRoundTrip)
                   .corrections_to_tolerance.has_value());
  EXPECT_FALSE(settling_of("box", {}, {}, kRoundTrip).corrections_to_tolerance.has_value());
}

}  // namespace
}  // namespace pcavr
