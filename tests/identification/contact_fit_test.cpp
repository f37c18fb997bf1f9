// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/identification/contact_fit.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "identification/plant.hpp"

namespace pcavr {
namespace {

/// Presses down to `depth`, held for 0.3 s and let go, at each speed.
std::vector<Trial> press_at(const Plant& plant, const Sensors& sensors, double depth,
                            const std::vector<double>& speeds, std::uint64_t seed) {
  std::vector<Trial> trials;
  for (const double speed : speeds) {
    const auto path = [=](double t) {
      const double down = speed * (t - 0.3);
      const double up = 2.0 * depth + 0.3 * speed - down;
      return std::max(std::min({down, depth, up}), -0.002);
    };
    trials.push_back(run(plant, sensors, 2.0 * depth / speed + 0.9, seed++, path));
  }
  return trials;
}

std::vector<ForceMotion> series_of(const std::vector<Trial>& trials) {
  std::vector<ForceMotion> series;
  for (const Trial& trial : trials) series.push_back(trial.series());
  return series;
}

TEST(IdentifyContact, FindsAHuntCrossleyContactFromPressesAtSeveralSpeeds) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(seed);
    Plant plant;
    plant.is_held = true;
    plant.stiffness = random.uniform(1.5e4, 2.5e5);
    plant.damping = plant.stiffness * random.uniform(2.0, 4.0);
    plant.exponent = random.uniform(1.3, 1.7);
    Sensors sensors;
    sensors.spike_share = 0.002;
    const auto trials = press_at(plant, sensors, 0.004, {0.005, 0.01, 0.02, 0.05}, 100 * seed);
    const ContactIdentification found = identify_contact(series_of(trials));
    ASSERT_TRUE(found.hunt_crossley.is_valid);
    EXPECT_EQ(found.chosen, ContactRegressor::hunt_crossley);
    const ContactFit& fit = found.best();
    // Four deviations of one number each, and these must be worth having.
    EXPECT_NEAR(fit.exponent.value, plant.exponent, 4.0 * fit.exponent.deviation);
    EXPECT_LT(fit.exponent.deviation, 0.1);
    EXPECT_NEAR(std::log(fit.stiffness.value / plant.stiffness), 0.0,
                4.0 * fit.stiffness.deviation / fit.stiffness.value);
    // What is felt: the force at 3 mm and 10 mm/s, within 2 %.
    const auto force = [](double k, double lambda, double n) {
      return (k + 0.01 * lambda) * std::pow(0.003, n);
    };
    const double truth = force(plant.stiffness, plant.damping, plant.exponent);
    const double felt = force(fit.stiffness.value, fit.damping.value, fit.exponent.value);
    EXPECT_NEAR(felt, truth, 0.03 * truth);  // the surface's place takes up another part
    EXPECT_TRUE(found.proposal.empty()) << found.proposal;
  }
}

TEST(IdentifyContact, ChoosesTheLinearLawForALinearContact) {
  Plant plant;
  plant.is_held = true;
  plant.exponent = 1.0;
  plant.stiffness = 3000.0;
  plant.damping = 0.0;
  const auto trials = press_at(plant, {}, 0.004, {0.01, 0.03}, 7);
  const ContactIdentification found = identify_contact(series_of(trials));
  ASSERT_TRUE(found.mass_damper_spring.is_valid);
  EXPECT_EQ(found.chosen, ContactRegressor::mass_damper_spring);
  EXPECT_NEAR(found.best().stiffness.value, 3000.0, 30.0);
  EXPECT_NEAR(found.best().surface[0], 0.0, 1e-4);
}

TEST(IdentifyContact, SaysThatAHeldPressShowsNoDamping) {
  Plant plant;
  plant.is_held = true;
  plant.exponent = 1.0;
  plant.stiffness = 3000.0;
  const auto path = [](double t) { return 0.003 + 0.0002 * std::sin(0.5 * t); };
  const Trial trial = run(plant, {}, 6.0, 3, path);
  const ForceMotion series = trial.series();
  const ContactIdentification found = identify_contact(std::span(&series, 1));
  EXPECT_FALSE(found.best().damping.is_excited);
  EXPECT_FALSE(found.proposal.empty());
}

TEST(IdentifyContact, HasNoAnswerWithoutContact) {
  EXPECT_FALSE(identify_contact({}).best().is_valid);
  const Trial trial = run({}, {}, 1.0, 3, [](double) { return -0.01; });
  const ForceMotion series = trial.series();
  const ContactIdentification found = identify_contact(std::span(&series, 1));
  EXPECT_FALSE(found.best().is_valid);
  EXPECT_FALSE(found.proposal.empty());
}

}  // namespace
}  // namespace pcavr
