// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/breakaway_motion.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "identification/plant.hpp"

namespace pcavr {
namespace {

Plant random_plant(Random& random) {
  Plant plant;
  plant.mass = random.uniform(0.8, 4.5);
  plant.breakaway = plant.mass * random.uniform(3.0, 7.0);
  plant.coulomb = plant.breakaway * random.uniform(0.75, 0.9);
  plant.stribeck_speed = random.uniform(0.002, 0.004);
  plant.viscous = random.uniform(4.0, 25.0);
  plant.bristle = plant.breakaway / random.uniform(2e-6, 1e-5);
  plant.stiffness = random.uniform(1.5e4, 2e5);
  plant.damping = 3.5 * plant.stiffness;
  return plant;
}

/// The object as presses and slides give it, some per cent off.
PushedObject known_of(const Plant& plant, Random& random) {
  PushedObject object{.contact_law = {plant.stiffness, plant.damping, plant.exponent},
                      .compliance_std = 0.1,
                      .damping_std = 1.0,
                      .mass = plant.mass,
                      .mass_std = 0.005,
                      .sliding = {plant.coulomb, plant.viscous},
                      .stribeck_speed = 0.003};
  object.contact_law.stiffness *= std::exp(-0.1 * plant.exponent * random.normal());
  object.sliding_covariance << std::pow(0.02 * plant.coulomb, 2), 0.0, 0.0, 4.0;
  object.sliding +=
      object.sliding_covariance.llt().matrixL() * Eigen::Vector2d(random.normal(), random.normal());
  return object;
}

/// A path at a constant speed [m/s]; or, as a person pushes, one that is held just below the limit
/// and then accelerated to that speed.
std::function<double(double)> path_of(const Plant& plant, double speed, bool is_held) {
  if (!is_held) return [=](double t) { return speed * (t - 0.3); };
  const double depth = std::pow(0.88 * plant.breakaway / plant.stiffness, 1.0 / plant.exponent);
  return [=](double t) {
    constexpr double kAcceleration = 1.2, kHold = 1.0;
    if (t < kHold) return std::min(0.012 * (t - 0.3), depth);
    const double ramp = std::min(t - kHold, speed / kAcceleration);
    return depth + 0.5 * kAcceleration * ramp * ramp + speed * (t - kHold - ramp);
  };
}

double squared(double value) { return value * value; }

TEST(LimitByMotion, CoversTheLimitOfPushesThatOvershootItByHalf) {
  Random random(8801);
  double errors = 0.0, peak_errors = 0.0, largest_peak = 0.0;
  int within_one = 0;
  constexpr int kPushes = 40;
  for (int i = 0; i < kPushes; ++i) {
    const Plant plant = random_plant(random);
    const double speed = random.uniform(0.01, 0.06);
    const Trial trial = run(plant, {}, 1.6, 8900 + static_cast<std::uint64_t>(i),
                            path_of(plant, speed, i % 2 == 0));
    const Breakaway breakaway = find_breakaway(trial.series());
    ASSERT_TRUE(breakaway.is_found) << i;
    const LimitOfMotion found = limit_by_motion(trial.series(), breakaway, known_of(plant, random));
    ASSERT_TRUE(found.limit.is_excited) << i;
    const double std = std::hypot(found.limit.std, found.shared_std);
    const double error = found.limit.value - plant.breakaway;
    EXPECT_LT(std::abs(error), 3.0 * std)
        << i << ": " << found.limit.value << " +- " << std << ", truth " << plant.breakaway;
    within_one += std::abs(error) < std ? 1 : 0;
    errors += squared(error / plant.breakaway) / kPushes;
    const double peak_error = breakaway.force / plant.breakaway - 1.0;
    peak_errors += squared(peak_error) / kPushes;
    largest_peak = std::max(largest_peak, peak_error);
  }
  RecordProperty("rms_percent", std::to_string(100.0 * std::sqrt(errors)));
  RecordProperty("peak_rms_percent", std::to_string(100.0 * std::sqrt(peak_errors)));
  EXPECT_GT(largest_peak, 0.5);
  EXPECT_LT(errors, squared(0.3) * peak_errors);
  EXPECT_GE(within_one, 21);  // of 40: the lower end of what the normal distribution gives
}

TEST(LimitByMotion, IsLessCertainInAFasterPush) {
  Random random(8802);
  const Plant plant;
  const PushedObject known = known_of(plant, random);
  double before = 0.0;
  for (const double speed : {0.01, 0.03, 0.06}) {
    const Trial trial = run(plant, {}, 1.6, 8803, path_of(plant, speed, false));
    const LimitOfMotion found =
        limit_by_motion(trial.series(), find_breakaway(trial.series()), known);
    const double std = std::hypot(found.limit.std, found.shared_std);
    EXPECT_GT(std, before) << speed;
    before = std;
  }
}

TEST(LimitByMotion, IsNotClearlyAboveThePeakWhateverIsKnown) {
  Random random(8804);
  const Plant plant;
  PushedObject known = known_of(plant, random);
  known.sliding[0] = 1.5 * plant.breakaway;
  const Trial trial = run(plant, {}, 1.6, 8805, path_of(plant, 0.01, false));
  const Breakaway breakaway = find_breakaway(trial.series());
  const LimitOfMotion found = limit_by_motion(trial.series(), breakaway, known);
  ASSERT_TRUE(found.limit.is_excited);
  EXPECT_LT(found.limit.value, 1.03 * breakaway.force + breakaway.std);
}

TEST(LimitByMotion, KeepsItsPriorWhereThatIsNarrow) {
  Random random(8807);
  const Plant plant;
  const PushedObject known = known_of(plant, random);
  const Trial trial = run(plant, {}, 1.6, 8808, path_of(plant, 0.06, false));
  const Breakaway breakaway = find_breakaway(trial.series());
  BreakawayPriors priors;
  priors.excess_factor = 1.02;
  const LimitOfMotion narrow = limit_by_motion(trial.series(), breakaway, known, priors);
  const LimitOfMotion wide = limit_by_motion(trial.series(), breakaway, known);
  ASSERT_TRUE(narrow.limit.is_excited && wide.limit.is_excited);
  EXPECT_LT(std::hypot(narrow.limit.std, narrow.shared_std),
            std::hypot(wide.limit.std, wide.shared_std));
}

TEST(LimitByMotion, IsNotExcitedWithoutABreakaway) {
  Random random(8806);
  const Plant plant;
  EXPECT_FALSE(limit_by_motion({}, {}, known_of(plant, random)).limit.is_excited);
}

}  // namespace
}  // namespace pcavr
