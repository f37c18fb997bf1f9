// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/object_identification/object_identification.hpp"

#include "identification/plant.hpp"

namespace pcavr {
namespace {

const Plant kLightBody{.mass = 0.98,
                       .coulomb = 2.2,
                       .breakaway = 2.8,
                       .viscous = 5.0,
                       .bristle = 6e5,
                       .stiffness = 1e5,
                       .damping = 3.5e5};

Contact contact_of(const Trial& trial) {
  Contact push;
  push.object = 0;
  push.normal_object = Eigen::Vector3d::UnitX();
  push.kind = ContactKind::slide;
  push.direction_base = Eigen::Vector3d::UnitX();
  push.t = trial.t;
  push.tool = trial.tool;
  push.force = trial.force;
  push.begin = 0.3;
  push.end = trial.t.back();
  push.peak_force = *std::max_element(push.force.begin(), push.force.end());
  push.breakaway = find_breakaway(trial.series());
  for (const double force : trial.force) {
    push.force_base.push_back(force * push.direction_base);
  }
  return push;
}

/// A push at 60 mm/s of a light body, whose inertia is half of the force's peak.
/// `rate` [Hz] of the log.
Contact fast_push(const Plant& plant, std::uint64_t seed, double rate = 500.0) {
  const Sensors sensors{.rate = rate, .force_noise = 0.05};
  return contact_of(run(plant, sensors, 1.6, seed, [](double t) { return 0.06 * (t - 0.3); }));
}

constexpr double kImpactMass = 1.2, kImpactFriction = 3.53;  // [kg], [N] at rest and sliding

/// A push at a speed [m/s] by a damped tip: its force jumps at the touch, to that of the damper.
Contact push_by_impact(double speed, std::uint64_t seed) {
  constexpr double kStep = 1e-4, kStiffness = 1e4, kDamping = 100.0;
  Random random(seed);
  Trial trial;
  double x = 0.0, v = 0.0, last_depth = 0.0;
  for (int i = 0; i < 16000; ++i) {
    const double t = kStep * i, tool = speed * (t - 0.3);
    const double depth = std::max(tool - x, 0.0);
    const double force =
        depth > 0.0 ? std::max(kStiffness * depth + kDamping * (depth - last_depth) / kStep, 0.0)
                    : 0.0;
    last_depth = depth;
    const bool rests = v <= 0.0 && force <= kImpactFriction;
    v = rests ? 0.0 : std::max(v + kStep / kImpactMass * (force - kImpactFriction), 0.0);
    x += kStep * v;
    if (i % 20 != 0) continue;  // 500 Hz
    trial.t.push_back(t);
    trial.tool.push_back(tool + 2e-5 * random.normal());
    trial.force.push_back(force + 0.05 * random.normal());
  }
  return contact_of(trial);
}

ObjectIdentification identify(std::vector<Contact>& contacts, double mass) {
  const Contact& contact = contacts[0];
  std::vector<Eigen::Vector3d> p_base_tip;
  for (const double x : contact.tool) p_base_tip.emplace_back(x, 0.0, 0.0);
  const PathView tip(contact.t, p_base_tip);
  const CadModel cad;
  ObjectIdentification found;
  found.parameters.mass = ParameterValue{mass, {}};
  identify_friction_of(contacts, 0, mass, {cad, {}}, tip, 0.005, {}, found);
  return found;
}

// Its peak is the limiting friction and the inertia of the object, whose contact law nothing gave.
TEST(IdentifyLimit, CoversThatOfAFastPushWithoutAContactLaw) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<Contact> contacts{fast_push(kLightBody, seed)};
    ASSERT_TRUE(contacts[0].breakaway.is_found) << seed;
    ASSERT_GT(contacts[0].breakaway.force, 1.3 * kLightBody.breakaway) << seed;
    const ObjectIdentification found = identify(contacts, kLightBody.mass);
    EXPECT_FALSE(found.parameters.contact_stiffness);
    ASSERT_TRUE(found.parameters.limiting_static_friction) << seed;
    const ParameterValue& limit = *found.parameters.limiting_static_friction;
    EXPECT_NEAR(limit.value, kLightBody.breakaway, 3.0 * *limit.std) << seed;
  }
}

// Its sliding is too short for an estimate of friction. The line of its loading is no contact law
// by which the onset of motion could be found.
TEST(IdentifyLimit, CoversThatOfAFastPushWithoutAContactLawOrSliding) {
  Plant slippery = kLightBody;
  slippery.coulomb = 1.3;
  slippery.breakaway = 1.8;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<Contact> contacts{fast_push(slippery, seed)};
    const ObjectIdentification found = identify(contacts, slippery.mass);
    ASSERT_FALSE(found.friction.is_valid) << seed;
    ASSERT_TRUE(found.parameters.limiting_static_friction) << seed;
    const ParameterValue& limit = *found.parameters.limiting_static_friction;
    EXPECT_NEAR(limit.value, slippery.breakaway, 2.0 * *limit.std) << seed;
  }
}

// Some samples make its peak, which is not the limiting friction: that is withheld, or covered.
TEST(IdentifyLimit, TakesNoInertiaOfAFastPushLoggedSlowlyForFriction) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<Contact> contacts{fast_push(kLightBody, seed, 100.0)};
    const ObjectIdentification found = identify(contacts, kLightBody.mass);
    if (!found.parameters.limiting_static_friction) continue;
    const ParameterValue& limit = *found.parameters.limiting_static_friction;
    EXPECT_NEAR(limit.value, kLightBody.breakaway, 3.0 * *limit.std) << seed;
  }
}

// The object slides from the touch on: no sample shows its rest under load. Its limiting friction
// is withheld, or covered.
TEST(IdentifyLimit, TakesNoImpactForFriction) {
  for (const double speed : {0.03, 0.04}) {
    std::vector<Contact> contacts{push_by_impact(speed, 1)};
    ASSERT_TRUE(contacts[0].breakaway.is_found) << speed;
    ASSERT_GT(contacts[0].breakaway.force, 1.4 * kImpactFriction) << speed;
    const ObjectIdentification found = identify(contacts, kImpactMass);
    ASSERT_TRUE(found.friction.is_valid) << speed;
    if (!found.parameters.limiting_static_friction) continue;
    const ParameterValue& limit = *found.parameters.limiting_static_friction;
    EXPECT_NEAR(limit.value, kImpactFriction, 2.0 * *limit.std) << speed;
  }
}

}  // namespace
}  // namespace pcavr
