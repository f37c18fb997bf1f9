// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/sliding.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "identification/plant.hpp"

namespace pcavr {
namespace {

constexpr double kTwoHertz = 4.0 * 3.14159265358979;  // [rad/s]

Plant random_plant(std::uint64_t seed) {
  Random random(seed);
  Plant plant;
  plant.mass = random.uniform(1.5, 5.0);
  plant.breakaway = plant.mass * random.uniform(3.0, 9.0);
  plant.coulomb = plant.breakaway * random.uniform(0.8, 0.92);
  plant.viscous = random.uniform(8.0, 30.0);
  plant.stiffness = random.uniform(2e4, 2.5e5);
  plant.damping = 3.0 * plant.stiffness;
  plant.bristle = 3e4 * plant.breakaway;
  return plant;
}

SlidingIdentification identify(const Plant& plant, double speed, double amplitude,
                               std::uint64_t seed, const SlidingOptions& options = {}) {
  const auto path = [=](double t) {
    const double since = t - 0.3;
    return speed * since + (since > 0.0 ? amplitude * std::sin(kTwoHertz * since) : 0.0);
  };
  Sensors sensors;
  sensors.spike_share = 0.001;
  const Trial trial = run(plant, sensors, 5.0, seed, path);
  const ForceMotion series = trial.series();
  return identify_sliding(std::span(&series, 1), {plant.stiffness, plant.damping, plant.exponent},
                          options);
}

TEST(IdentifySliding, FindsMassAndFrictionFromAnExcitingPush) {
  for (std::uint64_t seed = 6211; seed <= 6218; ++seed) {
    const Plant plant = random_plant(seed);
    const SlidingIdentification found = identify(plant, 0.06, 0.0035, 500 + seed);
    ASSERT_TRUE(found.is_valid);
    ASSERT_TRUE(found.mass.is_excited) << seed;
    EXPECT_NEAR(found.mass.value, plant.mass, 0.05 * plant.mass) << seed;
    EXPECT_NEAR(found.coulomb.value, plant.coulomb, 0.03 * plant.coulomb) << seed;
    EXPECT_NEAR(found.coefficient.value, plant.coulomb / plant.mass / 9.80665,
                0.05 * found.coefficient.value);
    EXPECT_TRUE(found.proposal.empty()) << found.proposal;
    EXPECT_FALSE(found.history.empty());
    const std::string at = std::to_string(seed);
    RecordProperty("mass_percent_" + at, std::to_string(100 * (found.mass.value / plant.mass - 1)));
    RecordProperty("coulomb_percent_" + at,
                   std::to_string(100 * (found.coulomb.value / plant.coulomb - 1)));
  }
}

TEST(IdentifySliding, ReportsThatASteadyPushDoesNotExciteTheMassAndProposesABetterOne) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Plant plant = random_plant(seed + 20);
    SlidingOptions options;
    options.mass = plant.mass;
    const SlidingIdentification found = identify(plant, 0.03, 0.0, 80 + seed, options);
    ASSERT_TRUE(found.is_valid);
    EXPECT_FALSE(found.mass.is_excited);
    EXPECT_FALSE(found.viscous.is_excited);
    EXPECT_NE(found.proposal.find("2 Hz, 3 mm"), std::string::npos);
    // Friction at this speed is known all the same.
    const double friction = plant.coulomb + plant.viscous * found.speed;
    EXPECT_NEAR(found.coulomb.value, friction, 0.03 * friction);
    EXPECT_NEAR(found.coefficient.value, friction / (plant.mass * 9.80665),
                0.03 * found.coefficient.value);
  }
}

TEST(IdentifySliding, IsRightAboutExcitationFromWeakToStrongPushes) {
  int excited = 0;
  for (const double amplitude : {0.0003, 0.001, 0.002, 0.0035}) {
    for (std::uint64_t seed = 5651; seed <= 5653; ++seed) {
      const Plant plant = random_plant(seed);
      const SlidingIdentification found = identify(plant, 0.06, amplitude, 600 + seed);
      ASSERT_TRUE(found.is_valid);
      const double friction = plant.coulomb + plant.viscous * found.speed;
      EXPECT_NEAR(found.coulomb.value + found.viscous.value * found.speed, friction,
                  0.005 * friction);
      if (found.mass.is_excited) {
        ++excited;
        EXPECT_NEAR(found.mass.value, plant.mass, 3.0 * found.mass.std) << amplitude;
      }
      if (found.viscous.is_excited) {
        ++excited;
        EXPECT_NEAR(found.viscous.value, plant.viscous, 3.0 * found.viscous.std) << amplitude;
      }
    }
  }
  EXPECT_GE(excited, 8);
}

TEST(IdentifySliding, IsRobustAgainstStopsAndLostContact) {
  int valid = 0;
  for (std::uint64_t seed = 6201; seed <= 6206; ++seed) {
    const Plant plant = random_plant(seed);
    const auto path = [](double t) {  // back and forth: stops, lost contact, continues
      return 0.05 * (t - 0.3) + 0.012 * std::sin(kTwoHertz * (t - 0.3));
    };
    const Trial trial = run(plant, {}, 6.0, 400 + seed, path);
    const ForceMotion series = trial.series();
    const SlidingIdentification found = identify_sliding(
        std::span(&series, 1), {plant.stiffness, plant.damping, plant.exponent}, {});
    EXPECT_LT(found.samples, trial.t.size() / 2);
    if (!found.is_valid) {  // with little friction it coasts ahead, between taps
      EXPECT_FALSE(found.proposal.empty());
      continue;
    }
    ++valid;
    const double friction = plant.coulomb + plant.viscous * found.speed;
    EXPECT_NEAR(found.coulomb.value + found.viscous.value * found.speed, friction, 0.03 * friction);
    EXPECT_NEAR(found.coulomb.value, plant.coulomb,
                std::max(0.03 * plant.coulomb, 3.0 * found.coulomb.std));
    ASSERT_TRUE(found.mass.is_excited) << seed;
    EXPECT_NEAR(found.mass.value, plant.mass, 0.05 * plant.mass) << seed;
  }
  EXPECT_GE(valid, 3);
}

TEST(IdentifySliding, IsInvalidForAnObjectAtRest) {
  Plant plant;
  plant.is_fixed = true;
  const SlidingIdentification found = identify(plant, 0.002, 0.0, 1);
  EXPECT_FALSE(found.is_valid);
  EXPECT_FALSE(found.proposal.empty());
  EXPECT_FALSE(identify_sliding({}, {1000.0, 0.0, 1.0}).is_valid);
}

TEST(PenetrationFromForce, InvertsTheContactLaw) {
  Plant plant;
  plant.is_fixed = true;
  Sensors exact;
  exact.force_noise = exact.tool_noise = 0.0;
  const auto path = [](double t) { return 0.002 + 0.001 * std::sin(9.0 * t); };
  const Trial trial = run(plant, exact, 2.0, 1, path);
  const auto depth = penetration_from_force(trial.t, trial.true_force,
                                            {plant.stiffness, plant.damping, plant.exponent});
  for (std::size_t i = 200; i < depth.size(); ++i) {
    EXPECT_NEAR(depth[i], path(trial.t[i]), 5e-6);  // implicit steps of 2 ms
  }
}

TEST(PenetrationFromForce, IsZeroWithoutForceAndFiniteForAnySpike) {
  const std::vector<double> t = {0.0, 0.002, 0.004, 0.006}, force = {0.0, -3.0, 1e6, 1e-9};
  const auto depth = penetration_from_force(t, force, {20600.0, 82400.0, 1.5});
  EXPECT_EQ(depth[0], 0.0);
  EXPECT_EQ(depth[1], 0.0);
  for (const double d : depth) EXPECT_TRUE(std::isfinite(d) && d >= 0.0);
}

}  // namespace
}  // namespace pcavr
