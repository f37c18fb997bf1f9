// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/options.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/options.hpp"
#include "pcavr/results/evaluation/object_errors.hpp"
#include "pcavr/results/evaluation/trajectory_errors.hpp"

#include "results/evaluation/force_errors.hpp"
#include "support/option_defaults.hpp"

namespace pcavr {
namespace {

TEST(EvaluationOptions, HaveTheirDocumentedDefaults) {
  test::expect_documented_defaults<TrajectoryErrorOptions>();
  test::expect_documented_defaults<MotionOptions>();
  test::expect_documented_defaults<ViewOptions>();
  test::expect_documented_defaults<SurfaceErrorOptions>();
  test::expect_documented_defaults<ForceErrorOptions>();
}

TEST(EvaluationOptions, SectionsHaveDistinctNames) {
  EvaluationOptions options;
  std::set<std::string> names;
  for (const OptionSection& section : sections_of(options)) {
    EXPECT_TRUE(names.insert(section.name).second) << section.name;
  }
  EXPECT_EQ(names.size(), 5U);
}

TEST(EvaluationOptions, MustBeInOrder) {
  MotionOptions motion;
  EXPECT_FALSE(section_of(motion).check());
  motion.speed_to_stop = 0.002;
  EXPECT_TRUE(section_of(motion).check());
  ViewOptions views;
  EXPECT_FALSE(section_of(views).check());
  views.max_depth = 0.3;
  EXPECT_TRUE(section_of(views).check());
}

/// Poses at 10 Hz for 2 s, moving along x.
Trajectory moving_at(double speed) {
  Trajectory path;
  for (int i = 0; i <= 20; ++i) {
    path.append(Stamp::from_seconds(0.1 * i), Pose::from_translation({speed * 0.1 * i, 0.0, 0.0}));
  }
  return path;
}

TEST(EvaluationOptions, RelativeStepSetsTheDistanceOfPairs) {
  const Trajectory path = moving_at(0.1);
  TrajectoryErrorOptions options;
  EXPECT_EQ(trajectory_errors(path, path, options).relative.size(), 11U);
  options.relative_step = 0.5;
  EXPECT_EQ(trajectory_errors(path, path, options).relative.size(), 16U);
}

TEST(EvaluationOptions, SpeedToStartDecidesOnMotion) {
  const std::vector<Stamp> middle = {Stamp::from_seconds(1.0)};
  MotionOptions options;
  EXPECT_TRUE(is_moving(moving_at(0.005), {}, middle, options)[0]);
  options.speed_to_start = 0.01;
  EXPECT_FALSE(is_moving(moving_at(0.005), {}, middle, options)[0]);
}

TEST(EvaluationOptions, ForcesSeparateContactsByTheirGap) {
  std::vector<ForceSample> samples;
  for (const double t : {1.0, 1.01, 1.12, 1.13}) {
    samples.push_back({Stamp::from_seconds(t), 4.0, 3.0});
  }
  ForceErrorOptions options;
  EXPECT_EQ(contact_peaks(samples, options).size(), 2U);
  options.contact_gap = 0.2;
  EXPECT_EQ(contact_peaks(samples, options).size(), 1U);
  options.min_relative_force = 5.0;
  EXPECT_TRUE(contact_peaks(samples, options).empty());
  EXPECT_TRUE(force_errors(samples, {}, options).all.relative.empty());
}

}  // namespace
}  // namespace pcavr
