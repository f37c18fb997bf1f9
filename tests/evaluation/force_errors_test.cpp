// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/evaluation/force_errors.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "run_samples.hpp"

namespace pcavr {
namespace {

TEST(ForceErrors, AreSplitByPhase) {
  const std::vector<ForceSample> samples = {{at(0.5), 0.0, 1.0},    // free: rendered too early
                                            {at(1.1), 4.0, 5.0},    // static
                                            {at(1.3), 10.0, 9.0},   // critical
                                            {at(1.6), 8.0, 8.0},    // sliding
                                            {at(1.7), 8.0, 10.0}};  // sliding
  const ForceErrors errors = force_errors(samples, one_push());
  EXPECT_EQ(errors.by_phase[0].difference, std::vector<double>({1.0}));
  EXPECT_TRUE(errors.by_phase[0].relative.empty());
  EXPECT_EQ(errors.by_phase[1].relative, std::vector<double>({0.25}));
  EXPECT_EQ(errors.by_phase[2].difference, std::vector<double>({-1.0}));
  EXPECT_EQ(magnitudes(errors.by_phase[2]), std::vector<double>({1.0}));
  EXPECT_EQ(errors.by_phase[3].relative, std::vector<double>({0.0, 0.25}));
  EXPECT_EQ(errors.in_contact.difference.size(), 4U);
  EXPECT_EQ(errors.all.difference.size(), 5U);
}

TEST(ForceErrors, AreRelativeOnlyFromTheMinimumForceOn) {
  const ForceErrors errors = force_errors({{at(1.1), 1.99, 3.0}, {at(1.11), 2.0, 3.0}}, one_push());
  EXPECT_EQ(errors.in_contact.relative, std::vector<double>({0.5}));
  EXPECT_EQ(errors.in_contact.difference.size(), 2U);
}

TEST(ForceErrors, WithoutPhasesAreNotSplit) {
  const ForceErrors errors = force_errors({{at(1.1), 4.0, 5.0}}, {});
  EXPECT_EQ(errors.all.relative, std::vector<double>({0.25}));
  EXPECT_TRUE(errors.in_contact.difference.empty());
  EXPECT_TRUE(force_errors({}, one_push()).all.difference.empty());
}

TEST(ContactPeaks, AreTheMaximaOfEachContact) {
  std::vector<ForceSample> samples;
  for (const double start : {1.0, 2.0}) {
    for (int i = 0; i < 10; ++i) {
      const double bump = i == 4 ? 5.0 : 1.0;
      samples.push_back({at(start + 0.01 * i), start * bump, start * bump + 0.5});
    }
  }
  const std::vector<ContactPeak> peaks = contact_peaks(samples);
  ASSERT_EQ(peaks.size(), 2U);
  EXPECT_EQ(peaks[0].measured, 5.0);
  EXPECT_EQ(peaks[0].rendered, 5.5);
  EXPECT_EQ(peaks[0].peak, at(1.04));
  EXPECT_EQ(peaks[1].measured, 10.0);
  EXPECT_EQ(peaks[1].begin, at(2.0));
  EXPECT_EQ(peaks[1].end, at(2.09));
}

TEST(ContactPeaks, AreNotRaisedByTheNoiseOfTheMeasuredForce) {
  Random random(5);
  std::vector<ForceSample> samples;
  for (int i = 0; i < 500; ++i) {
    samples.push_back({at(1.0 + 0.002 * i), 20.0 + 0.2 * random.normal(), 20.0});
  }
  const std::vector<ContactPeak> peaks = contact_peaks(samples);
  ASSERT_EQ(peaks.size(), 1U);
  EXPECT_NEAR(peaks[0].measured, 20.0, 0.25);  // the maximum is 0.6 N too high
  EXPECT_NEAR(peaks[0].rendered, 20.0, 1e-9);
}

TEST(ContactPeaks, ExcludeGrazingContacts) {
  EXPECT_TRUE(contact_peaks({{at(1.0), 0.3, 4.0}, {at(1.01), 1.9, 4.0}}).empty());
  EXPECT_TRUE(contact_peaks({}).empty());
}

TEST(ApproachSpeed, IsThatOfTheTipBeforeTheContact) {
  Trajectory tool;  // 20 mm/s until 1 s, then at rest; 100 poses a second
  for (int i = 0; i <= 200; ++i) {
    tool.append(at(0.01 * i), Pose::from_translation({0, 0, -0.02 * std::min(0.01 * i, 1.0)}));
  }
  ASSERT_TRUE(approach_speed(tool, at(1.0)).has_value());
  EXPECT_NEAR(*approach_speed(tool, at(1.0)), 0.02, 1e-9);
  EXPECT_NEAR(*approach_speed(tool, at(1.5)), 0.0, 1e-9);
  EXPECT_FALSE(approach_speed(tool, at(0.01)).has_value());
  EXPECT_FALSE(approach_speed({}, at(1.0)).has_value());
}

}  // namespace
}  // namespace pcavr
