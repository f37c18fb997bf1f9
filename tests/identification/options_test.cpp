// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <cmath>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/breakaway_motion.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/friction_posterior.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/sliding.hpp"

#include "plant.hpp"
#include "support/option_defaults.hpp"

namespace pcavr {
namespace {

Trial slow_push() {
  return run({}, {}, 3.0, 7, [](double t) { return 0.01 * (t - 0.3); });
}

TEST(IdentificationOptions, HaveTheirDocumentedDefaults) {
  test::expect_documented_defaults<SpikeOptions>();
  test::expect_documented_defaults<SaturationOptions>();
  test::expect_documented_defaults<TimeOffsetOptions>();
  test::expect_documented_defaults<ContactFitOptions>();
  test::expect_documented_defaults<BreakawayOptions>();
  test::expect_documented_defaults<OnsetOptions>();
  test::expect_documented_defaults<LimitingFrictionOptions>();
  test::expect_documented_defaults<SegmentationOptions>();
  test::expect_documented_defaults<SlidingOptions>();
  test::expect_documented_defaults<FrictionPriors>();
  test::expect_documented_defaults<BreakawayPriors>();
  test::expect_documented_defaults<EstimatorOptions<1>>();
  test::expect_documented_defaults<EstimatorOptions<4>>();
}

TEST(IdentificationOptions, SpikeThresholdDecidesWhatIsReplaced) {
  std::vector<double> values(100, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 2 == 0 ? 0.1 : -0.1;
  values[50] = 3.0;
  SpikeOptions options;
  EXPECT_EQ(remove_spikes(values, options).spikes, std::vector<std::size_t>{50});
  options.threshold = 100.0;
  EXPECT_TRUE(remove_spikes(values, options).spikes.empty());
}

TEST(IdentificationOptions, SaturationNeedsTheGivenNumberOfSamples) {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force;
  for (int i = 0; i < 200; ++i) {
    t.push_back(0.002 * i);
    const bool is_saturated = i >= 100 && i < 110;
    force.emplace_back(is_saturated ? 50.0 : 0.1 * std::sin(5.0 * i), 0.0, 0.0);
  }
  SaturationOptions options;
  EXPECT_EQ(find_saturation(t, force, options).size(), 1U);
  options.min_samples = 11;
  EXPECT_TRUE(find_saturation(t, force, options).empty());
}

TEST(IdentificationOptions, TimeOffsetIsSearchedWithinItsRange) {
  std::vector<double> t, a, b;
  for (int i = 0; i < 2000; ++i) {
    t.push_back(0.002 * i);
    a.push_back(std::exp(-8.0 * std::pow(t.back() - 1.8, 2)));
    b.push_back(std::exp(-8.0 * std::pow(t.back() - 2.2, 2)));  // 0.4 s later
  }
  TimeOffsetOptions options;
  EXPECT_GT(std::abs(estimate_time_offset(t, a, t, b, options).offset - 0.4), 0.1);
  options.range = 0.6;
  EXPECT_NEAR(estimate_time_offset(t, a, t, b, options).offset, 0.4, 0.004);
}

TEST(IdentificationOptions, BreakawayNeedsAForceAboveItsThreshold) {
  const Trial trial = slow_push();
  BreakawayOptions options;
  EXPECT_TRUE(find_breakaway(trial.series(), options).is_found);
  options.contact_threshold = 200.0;  // of 0.1 N: twice the push's 9.6 N
  EXPECT_FALSE(find_breakaway(trial.series(), options).is_found);
}

TEST(IdentificationOptions, CreepWidensTheStdOfTheOnset) {
  const Plant plant;
  const Trial trial = run(plant, {}, 1.6, 7, [](double t) { return 0.03 * (t - 0.3); });
  const Breakaway found = find_breakaway(trial.series());
  ASSERT_TRUE(found.is_found);
  const HuntCrossley law{plant.stiffness, plant.damping, plant.exponent};
  OnsetOptions options;
  const auto std_of = [&] {
    return friction_at_breakaway(trial.series(), found, law, plant.mass, options).std;
  };
  const double with_default = std_of();
  options.creep_share = 1.0;
  EXPECT_GT(std_of(), with_default);
}

TEST(IdentificationOptions, PushesWithALargeStdCountIfTheirRatioMayBeLarger) {
  std::vector<Breakaway> pushes(3);
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    pushes[i].is_found = true;
    pushes[i].force = 9.6;
    pushes[i].std = i == 2 ? 0.5 : 0.1;
  }
  LimitingFrictionOptions options;
  EXPECT_EQ(limiting_friction(pushes, options).pushes, 2);
  options.max_std_ratio = 6.0;
  EXPECT_EQ(limiting_friction(pushes, options).pushes, 3);
}

TEST(IdentificationOptions, SlidingIgnoresSpeedsBelowItsMinimum) {
  const Plant plant;
  const Trial trial = slow_push();
  const ForceMotion push = trial.series();
  const HuntCrossley law{plant.stiffness, plant.damping, plant.exponent};
  SlidingOptions options;
  EXPECT_TRUE(identify_sliding(std::span(&push, 1), law, options).is_valid);
  options.min_speed = 0.02;  // twice the push's
  EXPECT_FALSE(identify_sliding(std::span(&push, 1), law, options).is_valid);
}

TEST(IdentificationOptions, GravityScalesTheFrictionCoefficient) {
  const Plant plant;
  const Trial trial = slow_push();
  const ForceMotion push = trial.series();
  const HuntCrossley law{plant.stiffness, plant.damping, plant.exponent};
  SlidingOptions options;
  options.mass = plant.mass;
  const double on_earth = identify_sliding(std::span(&push, 1), law, options).coefficient.value;
  options.gravity /= 6.0;
  const double on_the_moon = identify_sliding(std::span(&push, 1), law, options).coefficient.value;
  EXPECT_NEAR(on_the_moon, 6.0 * on_earth, 1e-9);
}

TEST(IdentificationOptions, ExponentStaysBelowItsBound) {
  Plant plant;
  plant.is_fixed = true;
  const auto path = [](double t) { return std::min(0.01 * (t - 0.3), 0.004); };
  const Trial trial = run(plant, {}, 1.5, 3, path);
  const ForceMotion press = trial.series();
  ContactFitOptions options;
  EXPECT_GT(identify_contact(std::span(&press, 1), options).hunt_crossley.exponent.value, 1.3);
  options.max_exponent = 1.2;
  EXPECT_LE(identify_contact(std::span(&press, 1), options).hunt_crossley.exponent.value, 1.2);
}

TEST(IdentificationOptions, SegmentsNeedAForceAboveTheirMinimum) {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;
  for (int i = 0; i < 2000; ++i) {
    t.push_back(0.002 * i);
    const double pushed = t.back() > 1.5 && t.back() < 2.5 ? 2.0 : 0.0;
    force.emplace_back(pushed + 0.02 * std::sin(7.0 * i), 0.0, 0.0);
    tip.emplace_back(0.001 * t.back(), 0.0, 0.0);
  }
  SegmentationOptions options;
  EXPECT_EQ(segment_contacts(t, force, t, tip, options).contacts.size(), 1U);
  options.min_force = 3.0;
  EXPECT_TRUE(segment_contacts(t, force, t, tip, options).contacts.empty());
}

}  // namespace
}  // namespace pcavr
