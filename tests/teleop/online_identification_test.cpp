// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/online_identification.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/identification/segmentation.hpp"

#include "teleop/learned_friction.hpp"

namespace pcavr {
namespace {

constexpr double kStiffness = 1.0e6;  // [N/m^n] a hard face
constexpr double kExponent = 1.3;

/// Sensor data of the first tenths of a second of a push on a hard face: the tip's noise is a
/// considerable part of the penetration.
struct YoungContact {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;

  YoungContact(std::uint64_t seed, double pressed_for) {
    Random random(seed);
    for (double at = -0.3; at < pressed_for; at += 0.002) {
      const double penetration = std::max(0.0, 0.005 * at);  // 5 mm/s from t = 0
      t.push_back(at);
      force.emplace_back(0.2 * random.normal(),
                         kStiffness * std::pow(penetration, kExponent) + 0.2 * random.normal(),
                         0.2 * random.normal());
      tip.emplace_back(5e-5 * random.normal(), 0.005 * at + 5e-5 * random.normal(), 0.0);
    }
  }
};

/// Penetration at 40 N by a knowledge's parameters [m].
double penetration_of(const ObjectParameters& known) {
  return std::pow(40.0 / known.contact_stiffness->value, 1.0 / known.contact_exponent->value);
}

TEST(OnlineIdentification, KeepsAGivenLawAtTheStartOfAContact) {
  ObjectParameters given;
  given.mass = ParameterValue{4.0};
  given.contact_stiffness = ParameterValue{kStiffness, 1e4};
  given.contact_exponent = ParameterValue{kExponent, 0.01};
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    for (const double pressed_for : {0.08, 0.1, 0.15}) {
      const YoungContact contact(seed, pressed_for);
      ASSERT_EQ(segment_contacts(contact.t, contact.force, contact.t, contact.tip).contacts.size(),
                1U);
      OnlineIdentification knowledge = knowledge_of_box(given);
      knowledge.learn({contact.t, contact.force, contact.t, contact.tip, {}, 0.0, {}});
      EXPECT_NEAR(penetration_of(knowledge.known()) / penetration_of(given), 1.0, 0.4)
          << "seed " << seed << ", pressed for " << pressed_for << " s";
    }
  }
}

/// A press of something soft at 20 mm/s, from above, as far as it has come.
struct SoftPress {
  static constexpr double kSoftStiffness = 3500.0;  // [N/m^n]
  static constexpr double kSoftExponent = 1.35;
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;

  SoftPress(std::uint64_t seed, double pressed_for) {
    Random random(seed);
    for (double at = -0.3; at < pressed_for; at += 0.002) {
      const double depth = std::max(0.0, 0.02 * at);
      t.push_back(at);
      force.emplace_back(0.1 * random.normal(), 0.1 * random.normal(),
                         -kSoftStiffness * std::pow(depth, kSoftExponent) + 0.1 * random.normal());
      tip.emplace_back(5e-5 * random.normal(), 5e-5 * random.normal(),
                       -0.02 * at + 5e-5 * random.normal());
    }
  }
};

TEST(OnlineIdentification, LearnsALinearLawBeforeTheExponentIsKnown) {
  int linear = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SoftPress press(seed, 0.15);  // to 1.4 N
    OnlineIdentification knowledge = knowledge_of_box({});
    knowledge.learn({press.t, press.force, press.t, press.tip, {}, 0.0, {}});
    if (!knowledge.known().contact_stiffness) continue;
    linear += knowledge.known().contact_exponent->value == 1.0 ? 1 : 0;
    // The object's own force where the press may go, at 10 mm: an assumed law has fifty times that.
    constexpr double kDepth = 0.01;
    const double own = SoftPress::kSoftStiffness * std::pow(kDepth, SoftPress::kSoftExponent);
    const double learnt = knowledge.known().contact_stiffness->value *
                          std::pow(kDepth, knowledge.known().contact_exponent->value);
    EXPECT_GT(learnt, 0.3 * own) << seed;
    EXPECT_LT(learnt, 2.0 * own) << seed;
  }
  EXPECT_GT(linear, 10);
}

/// A short press of a hard face, from above: stiffness and exponent are known to a third only, but
/// not apart from each other, so that the penetration is.
TEST(OnlineIdentification, LearnsALawWhoseErrorsCompensateEachOther) {
  constexpr double kHard = 6.4e6, kCurved = 1.53, kSpeed = 0.002;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    std::vector<double> t;
    std::vector<Eigen::Vector3d> force, tip;
    for (double at = -0.3; at < 0.4; at += 0.002) {
      const double depth = kSpeed * std::min(std::max(0.0, at), 0.27);
      const double load = kHard * std::pow(depth, kCurved);
      t.push_back(at);
      force.emplace_back(0.2 * random.normal(), 0.2 * random.normal(),
                         -load + 0.2 * random.normal());
      tip.emplace_back(2e-5 * random.normal(), 2e-5 * random.normal(),
                       -kSpeed * std::min(at, 0.27) + 2e-5 * random.normal());
    }
    OnlineIdentification knowledge = knowledge_of_box({});
    knowledge.learn({t, force, t, tip, {}, 0.0, {}});
    ASSERT_TRUE(knowledge.known().contact_stiffness) << seed;
    const double expected = std::pow(40.0 / kHard, 1.0 / kCurved);
    EXPECT_NEAR(penetration_of(knowledge.known()) / expected, 1.0, 0.1) << seed;
  }
}

TEST(OnlineIdentification, KeepsNoCorrelationOfTheLawThatItReplaces) {
  constexpr double kHard = 6.4e6, kCurved = 1.53, kSpeed = 0.002;
  Random random(1);
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;
  for (double at = -0.3; at < 0.4; at += 0.002) {
    const double depth = kSpeed * std::min(std::max(0.0, at), 0.27);
    t.push_back(at);
    force.emplace_back(0.0, 0.0, -kHard * std::pow(depth, kCurved) + 0.2 * random.normal());
    tip.emplace_back(0.0, 0.0, -kSpeed * std::min(at, 0.27));
  }
  ObjectParameters given;  // ten times too soft
  given.contact_stiffness = ParameterValue{0.1 * kHard, 0.01 * kHard};
  given.contact_exponent = ParameterValue{kCurved, 0.05};
  given.sources.correlated = {"contact.stiffness", "contact.exponent", "mass"};
  given.sources.correlation = {1.0, 0.9, 0.0, 0.9, 1.0, 0.0, 0.0, 0.0, 1.0};
  OnlineIdentification knowledge = knowledge_of_box(given);
  knowledge.learn({t, force, t, tip, {}, 0.0, {}});
  ASSERT_NE(knowledge.known().contact_stiffness->value, given.contact_stiffness->value);
  EXPECT_EQ(knowledge.known().sources.correlated, std::vector<std::string>{"mass"});
}

/// A slow push under which the object gives way by 2 mm at 2.3 N, as on a loose sheet, before
/// it breaks away at 19 N and slides at 15 N.
struct LoosePush {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;

  explicit LoosePush(double until, double speed = 0.005) {
    constexpr double kContact = 5.0e3;  // [N/m]
    Random random(1);
    double object = 0.0;
    bool has_broken_away = false;
    for (double at = -0.5; at < until; at += 0.002) {
      const double tool = speed * at;
      const bool is_loose = object < 0.002;
      const double limit = is_loose ? 2.3 : has_broken_away ? 15.0 : 19.0;
      double load = kContact * std::max(0.0, tool - object);
      if (load > limit) {
        has_broken_away = !is_loose;
        load = is_loose ? 2.0 : 15.0;
        object = tool - load / kContact;
      }
      t.push_back(at);
      force.emplace_back(0.05 * random.normal(), load + 0.05 * random.normal(),
                         0.05 * random.normal());
      tip.emplace_back(1e-5 * random.normal(), tool + 1e-5 * random.normal(), 0.0);
    }
  }
};

TEST(OnlineIdentification, LearnsNoLimitFarBelowTheSlidingForce) {
  ObjectParameters given;
  given.mass = ParameterValue{4.0};
  OnlineIdentification knowledge = knowledge_of_box(given);
  for (const double until : {0.3, 2.0, 3.0}) {
    const LoosePush push(until);
    learn_with_friction(knowledge,
                        {push.t, push.force, push.t, push.tip, {}, 0.0, {.has_slid = true}});
    const auto& limit = knowledge.known().limiting_static_friction;
    if (until < 0.5) continue;
    EXPECT_TRUE(!limit || limit->value > 14.0) << until;
    EXPECT_TRUE(limit || knowledge.contradiction()) << until;
  }
}

TEST(OnlineIdentification, AssumesTheFrictionOfASlideUntilItIsSearchedFor) {
  ObjectParameters given;
  given.mass = ParameterValue{4.0};
  OnlineIdentification knowledge = knowledge_of_box(given);
  const LoosePush push(1.2, 0.02);
  knowledge.learn({push.t, push.force, push.t, push.tip, {}, 0.0, {.has_slid = true}});
  const ObjectParameters known = knowledge.known();
  ASSERT_TRUE(known.sliding_friction_coefficient && known.viscous_friction);
  const double coulomb = known.sliding_friction_coefficient->value * 4.0 * 9.80665;
  EXPECT_NEAR(coulomb + known.viscous_friction->value * 0.02, 15.0, 1.0);
  ASSERT_TRUE(known.limiting_static_friction);
  EXPECT_GT(known.limiting_static_friction->value, coulomb);
  EXPECT_NEAR(known.limiting_static_friction->value, 19.0,
              2.0 * *known.limiting_static_friction->std);
}

/// A push on a soft face, after 2 to 3 mm of which the object breaks away at 19 N and slides at 15.
struct SoftPush {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;

  SoftPush() {
    constexpr double kSoft = 4.0e4, kSpeed = 0.01;  // [N/m^n], [m/s]
    const double slipping = std::pow(15.0 / kSoft, 1.0 / kExponent);
    Random random(1);
    bool has_broken_away = false;
    for (double at = -0.5; at < 1.0; at += 0.002) {
      const double depth = has_broken_away ? slipping : std::max(0.0, kSpeed * at);
      const double load = kSoft * std::pow(depth, kExponent);
      has_broken_away = has_broken_away || load > 19.0;
      t.push_back(at);
      force.emplace_back(0.05 * random.normal(), load + 0.05 * random.normal(),
                         0.05 * random.normal());
      tip.emplace_back(1e-5 * random.normal(), kSpeed * at + 1e-5 * random.normal(), 0.0);
    }
  }
};

TEST(OnlineIdentification, HasALawByPushesAsUnsureAsCreepLeavesIt) {
  ObjectParameters given;
  given.mass = ParameterValue{4.0};
  OnlineIdentification knowledge = knowledge_of_box(given);
  const SoftPush push;
  knowledge.learn({push.t, push.force, push.t, push.tip, {}, 0.0, {.has_slid = true}});
  const std::optional<ParameterValue> learned = knowledge.known().contact_exponent;
  ASSERT_TRUE(learned);
  EXPECT_EQ(learned->value, kExponentOfPushes);
  EXPECT_EQ(learned->std, kExponentStdOfPushes);
  EXPECT_FALSE(knowledge.known().contact_damping);
}

TEST(OnlineIdentification, LearnsTheFrictionOfASlideWithoutAContactLaw) {
  ObjectParameters given;
  given.mass = ParameterValue{4.0};
  LearningOptions options;
  options.max_fit_error = 0.0;  // no law is good enough
  OnlineIdentification knowledge = knowledge_of_box(given, options);
  const LoosePush push(1.5, 0.02);
  learn_with_friction(knowledge,
                      {push.t, push.force, push.t, push.tip, {}, 0.0, {.has_slid = true}});
  EXPECT_FALSE(knowledge.known().contact_stiffness);
  // One speed fixes the sum of Coulomb and viscous friction.
  const ObjectParameters& known = knowledge.known();
  ASSERT_TRUE(known.sliding_friction_coefficient && known.viscous_friction);
  EXPECT_NEAR(
      known.sliding_friction_coefficient->value * 4.0 * 9.81 + known.viscous_friction->value * 0.02,
      15.0, 0.3);
}

}  // namespace
}  // namespace pcavr
