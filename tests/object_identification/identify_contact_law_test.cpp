// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "physics/object_identification/contact_fits.hpp"
#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

constexpr double kRowInterval = 0.002;  // [s]
constexpr double kTipSpeed = 0.01;      // [m/s] of the tip
constexpr double kWayToTouch = 0.005;   // [m] of the tip's way before it touches

/// The contact law of a push whose force [N] is a function of the way since touch [m].
ObjectIdentification law_of(const std::function<double(double)>& force_at, double way) {
  Contact contact;
  contact.object = 0;
  contact.direction_base = Eigen::Vector3d::UnitX();
  std::vector<Eigen::Vector3d> p_base_tip;
  Random random(1);
  for (double x = -kWayToTouch; x < way; x += kTipSpeed * kRowInterval) {
    contact.t.push_back((x + kWayToTouch) / kTipSpeed);
    contact.tool.push_back(x);
    const double force = x < 0.0 ? 0.0 : force_at(x);
    contact.force.push_back(force + 0.01 * random.normal());
    contact.force_base.push_back(contact.force.back() * contact.direction_base);
    p_base_tip.emplace_back(x, 0.0, 0.0);
  }
  contact.begin = kWayToTouch / kTipSpeed;
  contact.end = contact.t.back();
  contact.peak_force = *std::max_element(contact.force.begin(), contact.force.end());
  contact.normal_object = Eigen::Vector3d::UnitX();
  std::vector<Contact> contacts{contact};
  ObjectIdentification result;
  const PathView tip(contact.t, p_base_tip);
  ContactFits fits;
  identify_contact_of(contacts, 0, tip, IdentificationOptions{}, fits, result);
  return result;
}

TEST(IdentifyContacts, GiveTheLawOfAPushUntilItsBreakaway) {
  const ObjectIdentification found =
      law_of([](double depth) { return 3e4 * std::pow(depth, 1.5); }, 0.003);
  ASSERT_EQ(found.faces.size(), 1U);
  ASSERT_TRUE(found.parameters.contact_stiffness);
  EXPECT_NEAR(found.parameters.contact_stiffness->value, 3e4, 0.05 * 3e4);
}

// Its exponent is assumed, and so is the stiffness's unit: only the penetration is a result.
TEST(IdentifyContacts, StateThePenetrationOfAPushAndNoStiffness) {
  ObjectIdentification found =
      law_of([](double depth) { return 1e4 * std::pow(depth, 1.3); }, 0.003);
  ASSERT_TRUE(found.parameters.contact_stiffness);
  EXPECT_FALSE(found.parameters.contact_stiffness->std);
  EXPECT_EQ(found.parameters.sources.pushes.count("contact.stiffness"), 0U);
  state_penetration({}, found);
  ASSERT_TRUE(found.penetration.depth.is_excited);
  const double depth = std::pow(found.penetration.force / 1e4, 1.0 / 1.3);
  EXPECT_NEAR(found.penetration.depth.value, depth, 2.0 * found.penetration.depth.std);
}

// An object that slides while its friction grows is no spring of a metre.
TEST(IdentifyContacts, WithholdALawThatIsDeeperThanTheTipMoved) {
  const ObjectIdentification found =
      law_of([](double way) { return std::min(1.7, 3e3 * way) + 3.0 * way; }, 0.1);
  ASSERT_EQ(found.faces.size(), 1U);
  EXPECT_FALSE(found.parameters.contact_stiffness)
      << found.parameters.contact_stiffness->value << " N/m^n";
}

}  // namespace
}  // namespace pcavr
