// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/object_learner.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/core/random.hpp"
#include "pcavr/identification/segmentation.hpp"

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

/// Penetration at 40 N by a learner's parameters [m].
double penetration_of(const ObjectParameters& known) {
  return std::pow(40.0 / known.contact_stiffness->value, 1.0 / known.contact_exponent->value);
}

TEST(ObjectLearner, KeepsAGivenLawAtTheStartOfAContact) {
  ObjectParameters given;
  given.mass = ParameterValue{4.0};
  given.contact_stiffness = ParameterValue{kStiffness, 1e4};
  given.contact_exponent = ParameterValue{kExponent, 0.01};
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    for (const double pressed_for : {0.08, 0.1, 0.15}) {
      const YoungContact contact(seed, pressed_for);
      ASSERT_EQ(segment_contacts(contact.t, contact.force, contact.t, contact.tip).contacts.size(),
                1U);
      ObjectLearner learner(given, {});
      learner.learn({contact.t, contact.force, contact.t, contact.tip}, 0.0, {});
      EXPECT_NEAR(penetration_of(learner.known()) / penetration_of(given), 1.0, 0.4)
          << "seed " << seed << ", pressed for " << pressed_for << " s";
    }
  }
}

}  // namespace
}  // namespace pcavr
