// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/contact_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/local_direction.hpp"
#include "pcavr/physics/identification/signals.hpp"

#include "identification/plant.hpp"

namespace pcavr {
namespace {

/// A path down to `depth`, constant for 0.3 s and released.
double press_path(double t, double depth, double speed) {
  const double down = speed * (t - 0.3);
  const double up = 2.0 * depth + 0.3 * speed - down;
  return std::max(std::min({down, depth, up}), -0.002);
}

std::vector<Trial> press_at(const Plant& plant, const Sensors& sensors, double depth,
                            const std::vector<double>& speeds, std::uint64_t seed) {
  std::vector<Trial> trials;
  for (const double speed : speeds) {
    const auto path = [=](double t) { return press_path(t, depth, speed); };
    trials.push_back(run(plant, sensors, 2.0 * depth / speed + 0.9, seed++, path));
  }
  return trials;
}

/// Cramer-Rao bound: the minimum std of any unbiased estimator [Cramer 1946; Rao 1945].
struct Bound {
  double exponent = 0.0;
  double force_share = 0.0;  ///< of the force at 3 mm and 10 mm/s
};

/// The unknowns are log k, lambda / k, n and the surface; each sample has the sensor's
/// noise and the propagated noise of the tool, F n / d. Samples count where contact is sure: above
/// six stds of the smoothed force.
Bound cramer_rao(const Plant& plant, const Sensors& sensors, double depth,
                 const std::vector<double>& speeds) {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  const double c = plant.damping / plant.stiffness;
  const ContactFitOptions options;
  const double smoothed = correlated_samples(options.half_width, 1.0 / sensors.rate);
  const double min_force = options.contact_threshold * sensors.force_noise / std::sqrt(smoothed);
  for (const double speed : speeds) {
    for (int i = 0; i < static_cast<int>((2.0 * depth / speed + 0.9) * sensors.rate); ++i) {
      const double t = i / sensors.rate;
      const double d = press_path(t, depth, speed);
      const double rate = (press_path(t + 1e-4, depth, speed) - d) / 1e-4;
      if (d <= 0.0) continue;
      const double power = plant.stiffness * std::pow(d, plant.exponent);
      const double force = power * (1.0 + c * rate);
      if (force < min_force) continue;
      const Eigen::Vector4d slope(force, power * rate, force * std::log(d),
                                  -force * plant.exponent / d);
      const double noise = std::hypot(sensors.force_noise, slope[3] * sensors.tool_noise);
      information += slope * slope.transpose() / (noise * noise);
    }
  }
  const Eigen::Matrix4d covariance = information.inverse();
  const Eigen::Vector4d of_force(1.0, 0.01 / (1.0 + 0.01 * c), std::log(0.003), 0.0);
  return {std::sqrt(covariance(2, 2)), std::sqrt(of_force.dot(covariance * of_force))};
}

std::vector<ForceMotion> series_of(const std::vector<Trial>& trials) {
  std::vector<ForceMotion> series;
  for (const Trial& trial : trials) series.push_back(trial.series());
  return series;
}

TEST(IdentifyContact, FindsAHuntCrossleyContactCloseToTheCramerRaoBound) {
  const std::vector<double> speeds = {0.005, 0.01, 0.02, 0.05};
  for (std::uint64_t seed = 6101; seed <= 6106; ++seed) {
    Random random(seed);
    Plant plant;
    plant.is_fixed = true;
    plant.stiffness = random.uniform(1.5e4, 2.5e5);
    plant.damping = plant.stiffness * random.uniform(2.0, 4.0);
    plant.exponent = random.uniform(1.3, 1.7);
    Sensors sensors;
    sensors.spike_share = 0.002;
    const auto trials = press_at(plant, sensors, 0.004, speeds, 100 * seed);
    const ContactIdentification found = identify_contact(series_of(trials));
    ASSERT_TRUE(found.hunt_crossley.is_valid);
    EXPECT_EQ(found.chosen, ContactRegressor::hunt_crossley);
    const ContactFit& fit = found.best();
    // Soft contacts of 3 N leave 0.1 of the exponent open, whatever the method. In addition to the
    // bound 0.005 are allowed for the path's corners, which the smoothing rounds.
    const Bound bound = cramer_rao(plant, sensors, 0.004, speeds);
    EXPECT_LT(fit.exponent.std, 1.3 * std::hypot(bound.exponent, 0.005)) << seed;
    // Four stds of one number each.
    EXPECT_NEAR(fit.exponent.value, plant.exponent, 4.0 * fit.exponent.std);
    EXPECT_NEAR(std::log(fit.stiffness.value / plant.stiffness), 0.0,
                4.0 * fit.stiffness.std / fit.stiffness.value);
    // The rendered force at 3 mm and 10 mm/s.
    const auto force = [](double k, double lambda, double n) {
      return (k + 0.01 * lambda) * std::pow(0.003, n);
    };
    const double truth = force(plant.stiffness, plant.damping, plant.exponent);
    const double rendered = force(fit.stiffness.value, fit.damping.value, fit.exponent.value);
    EXPECT_NEAR(rendered, truth, std::hypot(0.01, 4.0 * bound.force_share) * truth) << seed;
    const std::string at = std::to_string(seed);
    RecordProperty("exponent_std_" + at, std::to_string(fit.exponent.std));
    RecordProperty("exponent_bound_" + at, std::to_string(bound.exponent));
    RecordProperty("force_percent_" + at, std::to_string(100.0 * (rendered / truth - 1.0)));
    RecordProperty("force_bound_percent_" + at, std::to_string(100.0 * bound.force_share));
    EXPECT_TRUE(found.proposal.empty()) << found.proposal;
  }
}

TEST(IdentifyContact, RemovesAMassThatOneFrequencyDoesNotSeparateFromTheStiffness) {
  Plant plant;
  plant.is_fixed = true;
  plant.exponent = 1.0;
  plant.stiffness = 500.0;
  plant.damping = 2.0;
  Sensors sensors;
  sensors.rate = 66.0;
  const auto path = [](double t) { return 0.003 + 0.001 * std::sin(4.0 * std::numbers::pi * t); };
  const Trial trial = run(plant, sensors, 4.0, 5011, path);
  const ForceMotion series = trial.series();
  const ContactFit fit = identify_contact(std::span(&series, 1)).mass_damper_spring;
  EXPECT_FALSE(fit.mass.is_excited);
  EXPECT_EQ(fit.mass.value, 0.0);
  // 0.2 N on 0.7 mm rms, 264 samples: 18 N/m; with the mass, a hundred.
  EXPECT_LT(fit.stiffness.std, 25.0);
  EXPECT_NEAR(fit.stiffness.value, 500.0, 4.0 * fit.stiffness.std);
}

TEST(IdentifyContact, ChoosesTheLinearLawForALinearContact) {
  Plant plant;
  plant.is_fixed = true;
  plant.exponent = 1.0;
  plant.stiffness = 3000.0;
  plant.damping = 0.0;
  const auto trials = press_at(plant, {}, 0.004, {0.01, 0.03}, 7);
  const ContactIdentification found = identify_contact(series_of(trials));
  ASSERT_TRUE(found.mass_damper_spring.is_valid);
  EXPECT_EQ(found.chosen, ContactRegressor::mass_damper_spring);
  EXPECT_NEAR(found.best().stiffness.value, 3000.0, 30.0);
  EXPECT_NEAR(found.best().surface[0], 0.0, 1e-4);
  // Chosen by a tie, so not exact.
  EXPECT_GT(found.best().exponent.std, 0.0);
}

TEST(IdentifyContact, FitsStiffnessAndDampingUnderAGivenExponent) {
  Plant plant;
  plant.is_fixed = true;
  plant.stiffness = 5e4;
  plant.damping = 1.5e5;
  plant.exponent = 1.5;
  const auto trials = press_at(plant, {}, 0.004, {0.01, 0.03}, 7);
  ContactFitOptions options;
  options.exponent = 1.5;
  const ContactIdentification free = identify_contact(series_of(trials));
  const ContactIdentification given = identify_contact(series_of(trials), options);
  ASSERT_TRUE(given.best().is_valid);
  EXPECT_EQ(given.chosen, ContactRegressor::hunt_crossley);
  EXPECT_EQ(given.best().exponent.value, 1.5);
  EXPECT_EQ(given.best().exponent.std, 0.0);
  EXPECT_NEAR(given.best().stiffness.value, 5e4, 4.0 * given.best().stiffness.std);
  // One whose std is given takes part in the stiffness's std, whose unit it is; and in that of the
  // penetration, which hardly depends on it.
  options.exponent = 1.4;
  const ContactFit conditional = identify_contact(series_of(trials), options).best();
  EXPECT_GT(std::abs(conditional.stiffness.value - 5e4), 5.0 * conditional.stiffness.std);
  options.exponent_std = 0.1;
  const ContactFit uncertain = identify_contact(series_of(trials), options).best();
  EXPECT_EQ(uncertain.exponent.std, 0.1);
  const double log_std = uncertain.stiffness.std / uncertain.stiffness.value;
  EXPECT_NEAR(std::log(uncertain.stiffness.value / 5e4), 0.0, 2.0 * log_std);
  EXPECT_LT(uncertain.penetration_std, 0.3 * log_std);
  options.exponent_std = 0.0;
  // The uncertainty of the exponent is most of the stiffness's std.
  EXPECT_LT(given.best().stiffness.std, 0.3 * free.best().stiffness.std);
  options.exponent = 0.5;
  EXPECT_THROW(static_cast<void>(identify_contact(series_of(trials), options)), ContractError);
}

/// A press of a stiff object, with smooth reversals; the tip is recorded between the force's
/// samples, as by a controller and a sensor of their own.
Trial brief_press(double duration, std::uint64_t seed) {
  Plant plant;
  plant.is_fixed = true;
  plant.stiffness = 1.8e5;
  plant.damping = 6.5e5;
  const Sensors sensors{.rate = 1000.0, .tool_noise = 5e-5};
  const auto path = [=](double t) {
    const double wave = std::sin(std::numbers::pi * std::clamp((t - 0.3) / duration, 0.0, 1.0));
    return 0.0049 * wave * wave - 0.004;
  };
  const Trial fine = run(plant, sensors, duration + 0.6, seed, path);
  Trial press;
  for (std::size_t i = 1; i + 1 < fine.t.size(); i += 2) {
    press.t.push_back(fine.t[i]);
    press.tool.push_back(0.5 * (fine.tool[i - 1] + fine.tool[i + 1]));
    press.force.push_back(fine.force[i]);
  }
  return press;
}

TEST(IdentifyContact, StatesTheErrorOfAStiffContactWhoseTipIsInterpolated) {
  constexpr int kDraws = 16;
  int covered = 0;
  double mean = 0.0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    std::vector<Trial> presses;
    for (const double duration : {2.0, 1.0, 0.5, 0.3})
      presses.push_back(brief_press(duration, 400 + 10 * draw + presses.size()));
    std::vector<ForceMotion> series = series_of(presses);
    for (ForceMotion& press : series) press.tool_noise = 5e-5 / std::numbers::sqrt2;
    const ContactFit fit = identify_contact(series).hunt_crossley;
    const double error = (fit.exponent.value - 1.5) / fit.exponent.std;
    mean += error / kDraws;
    covered += std::abs(error) < 2.0 ? 1 : 0;
  }
  EXPECT_GE(covered, kDraws - 3);
  EXPECT_LT(std::abs(mean), 0.75);  // three stds of the mean of 16
}

TEST(IdentifyContact, ReportsThatAConstantPressDoesNotExciteDamping) {
  Plant plant;
  plant.is_fixed = true;
  plant.exponent = 1.0;
  plant.stiffness = 3000.0;
  const auto path = [](double t) { return 0.003 + 0.0002 * std::sin(0.5 * t); };
  const Trial trial = run(plant, {}, 6.0, 3, path);
  const ForceMotion series = trial.series();
  const ContactIdentification found = identify_contact(std::span(&series, 1));
  EXPECT_FALSE(found.best().damping.is_excited);
  EXPECT_FALSE(found.proposal.empty());
}

TEST(IdentifyContact, IsInvalidWithoutContact) {
  EXPECT_FALSE(identify_contact({}).best().is_valid);
  const Trial trial = run({}, {}, 1.0, 3, [](double) { return -0.01; });
  const ForceMotion series = trial.series();
  const ContactIdentification found = identify_contact(std::span(&series, 1));
  EXPECT_FALSE(found.best().is_valid);
  EXPECT_FALSE(found.proposal.empty());
}

/// A tip that presses a spring of 500 N/m by 1 mm at 2 Hz, for 20 s, while its surface moves.
ContactIdentification press_moving_surface(double travel) {
  Random random(11);
  std::vector<double> t, tool, force;
  for (int i = 0; i < 1320; ++i) {
    const double now = i / 66.0;
    const double depth = 0.003 + 0.001 * std::sin(4.0 * std::numbers::pi * now);
    const double surface = travel * std::sin(0.25 * std::numbers::pi * now);
    const double is_near = now > 0.5 && now < 19.5 ? 1.0 : 0.0;
    t.push_back(now);
    tool.push_back(surface + (is_near > 0.0 ? depth : -0.005) + 1e-5 * random.normal());
    force.push_back(is_near * 500.0 * depth + 0.01 * random.normal());
  }
  const ForceMotion press{t, tool, force};
  return identify_contact(std::span(&press, 1));
}

TEST(IdentifyContact, FindsTheStiffnessOfASurfaceThatMovesUnderThePress) {
  const ContactIdentification found = press_moving_surface(0.004);
  ASSERT_TRUE(found.best().is_valid);
  EXPECT_NEAR(found.best().stiffness.value, 500.0, 0.03 * 500.0);
  EXPECT_FALSE(found.best().damping.is_excited);
  EXPECT_NE(found.proposal.find("the surface moves"), std::string::npos);
}

TEST(IdentifyContact, DoesNotTakeASurfaceThatStaysForOneThatMoves) {
  const ContactIdentification found = press_moving_surface(0.0);
  ASSERT_TRUE(found.best().is_valid);
  EXPECT_EQ(found.proposal.find("the surface moves"), std::string::npos);
}

/// Presses of half a second, each on another place of a linear surface, while the tip drifts along
/// it: the surface rises under it by up to 4 mm/s.
TEST(IdentifyContact, FindsTheStiffnessOfShortPressesOnPlacesThatDrift) {
  Random random(13);
  std::vector<std::vector<double>> t, tool, force;
  std::vector<ForceMotion> presses;
  constexpr int kPresses = 40, kSamples = 44;
  for (int p = 0; p < kPresses; ++p) {
    const double rise = random.uniform(-0.004, 0.004), stiffness = random.uniform(370.0, 430.0);
    t.emplace_back(), tool.emplace_back(), force.emplace_back();
    for (int i = 0; i < kSamples; ++i) {
      const double now = i / 66.0;
      const double depth = 0.003 * std::sin(2.0 * std::numbers::pi * (now - 0.08));
      t.back().push_back(now);
      tool.back().push_back(depth + rise * now + 1e-5 * random.normal());
      force.back().push_back(stiffness * std::max(0.0, depth) + 0.005 * random.normal());
    }
  }
  for (int p = 0; p < kPresses; ++p) {
    const auto i = static_cast<std::size_t>(p);
    presses.push_back({t[i], tool[i], force[i]});
  }
  ContactFitOptions options;
  options.is_surface_shared = false;
  const ContactIdentification found = identify_contact(presses, options);
  ASSERT_TRUE(found.best().is_valid);
  EXPECT_EQ(found.chosen, ContactRegressor::mass_damper_spring);
  EXPECT_NEAR(found.best().stiffness.value, 400.0, 3.0 * found.best().stiffness.std);
  EXPECT_LT(found.best().stiffness.std, 0.07 * 400.0);
  EXPECT_FALSE(found.best().damping.is_excited);
}

/// A tip that travels over a cylinder, whose normal tilts by 20 degrees to either side, and presses
/// along z like the one above.
struct TravellingTip {
  std::vector<double> t, tool, force;
  std::vector<Eigen::Vector3d> p_base_tip, force_base;
};

TravellingTip travel_over_cylinder(double stiffness) {
  constexpr double kRadius = 0.05;
  const double reach = kRadius * std::sin(20.0 * std::numbers::pi / 180.0);
  Random random(12);
  const auto noise = [&](double std) {
    return Eigen::Vector3d(std * random.normal(), std * random.normal(), std * random.normal());
  };
  TravellingTip tip;
  for (int i = 0; i < 2640; ++i) {
    const double now = i / 66.0;
    const bool is_near = now > 0.5 && now < 39.5;
    const double depth = 0.003 + 0.001 * std::sin(4.0 * std::numbers::pi * now);
    const double x = reach * std::sin(0.125 * std::numbers::pi * now);
    const Eigen::Vector3d p(x, 0.0,
                            std::sqrt(kRadius * kRadius - x * x) - (is_near ? depth : -0.005));
    const double penetration = std::max(0.0, kRadius - p.norm());
    tip.t.push_back(now);
    tip.p_base_tip.emplace_back(p + noise(1e-5));
    tip.force_base.emplace_back(-stiffness * penetration * p.normalized() + noise(0.01));
    tip.tool.push_back(-tip.p_base_tip.back().z());
    tip.force.push_back(-tip.force_base.back().z());
  }
  return tip;
}

TEST(IdentifyContact, FollowsTheNormalOfACurvedSurfaceUnderATravellingTip) {
  const TravellingTip tip = travel_over_cylinder(500.0);
  const ForceMotion press{tip.t, tip.tool, tip.force};
  const ContactFitOptions options;
  const LocalContact contact = along_local_force(
      tip.t, tip.force_base, PathView(tip.t, tip.p_base_tip), options.moving_half_width);
  const ForceMotion local = contact.series({});
  const ContactFit along_z = identify_contact(std::span(&press, 1)).best();
  const ContactIdentification found =
      identify_contact(std::span(&press, 1), options, std::span(&local, 1));
  ASSERT_TRUE(found.best().is_valid);
  EXPECT_NE(found.proposal.find("the surface moves"), std::string::npos);
  EXPECT_NEAR(found.best().stiffness.value, 500.0, 0.03 * 500.0);
  EXPECT_LT(along_z.stiffness.value, 0.96 * 500.0);
  RecordProperty("local", std::to_string(found.best().stiffness.value));
  RecordProperty("along_z", std::to_string(along_z.stiffness.value));
}

TEST(IdentifyContact, AppliesTheOptionsOfASurfaceThatMoves) {
  const TravellingTip tip = travel_over_cylinder(500.0);
  const ForceMotion press{tip.t, tip.tool, tip.force};
  const auto is_taken_as_moving = [&](const ContactFitOptions& options) {
    const ContactIdentification found = identify_contact(std::span(&press, 1), options);
    return found.proposal.find("the surface moves") != std::string::npos;
  };
  ContactFitOptions options;
  EXPECT_TRUE(is_taken_as_moving(options));
  options.min_moving_gain = 100.0;
  EXPECT_FALSE(is_taken_as_moving(options));
  options = {};
  options.moving_window = 20.0;  // one window, whose scatter is not known
  EXPECT_FALSE(is_taken_as_moving(options));
  options = {};
  options.moving_half_width = 30.0;  // longer than the press
  EXPECT_FALSE(is_taken_as_moving(options));
}

}  // namespace
}  // namespace pcavr
