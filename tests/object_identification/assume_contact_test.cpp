// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

constexpr double kContactStiffness = 2.0e6;  // [N/m^1.5]: 0.16 mm at 4 N
constexpr double kForceOfSliding = 4.0;

/// A push at `speed` [m/s] that is loaded through a contact and slides at 4 N, at 100 Hz; under the
/// load the object moves by a share of the tip's path.
Contact push_at(double speed, double creep, std::uint64_t seed) {
  Random random(seed);
  Contact push;
  push.object = 0;
  push.kind = ContactKind::slide;
  push.begin = 0.0;
  push.end = 3.0;
  for (double t = -0.3; t < 3.3; t += 0.01) {
    const bool is_free = t < 0.0 || t > 3.0;
    const double tool = speed * t;
    const double load = is_free ? 0.0 : kContactStiffness * std::pow((1.0 - creep) * tool, 1.5);
    push.t.push_back(t);
    push.tool.push_back(tool + 5e-6 * random.normal());
    push.force.push_back(std::min(load, kForceOfSliding) + 0.03 * random.normal());
  }
  return push;
}

/// A push at 2.5 mm/s.
Contact slow_push(std::uint64_t seed) { return push_at(0.0025, 0.0, seed); }

ObjectIdentification assumed_after(std::size_t pushes, const ObjectParameters& known = {}) {
  std::vector<Contact> contacts;
  for (std::size_t i = 0; i < pushes; ++i) contacts.push_back(slow_push(i + 1));
  ObjectIdentification result;
  result.parameters = known;
  assume_contact_by_loading(contacts, 0, result);
  return result;
}

TEST(IdentifyLoading, AssumesTheContactThatPushesAreLoadedThrough) {
  const ObjectIdentification found = assumed_after(3);
  ASSERT_TRUE(found.parameters.contact_stiffness);
  const double depth =
      std::pow(kForceOfSliding / found.parameters.contact_stiffness->value, 1.0 / 1.5);
  const double truth = std::pow(kForceOfSliding / kContactStiffness, 1.0 / 1.5);
  EXPECT_NEAR(depth / truth, 1.0, 0.2);
  EXPECT_FALSE(found.parameters.contact_stiffness->std);
  ASSERT_EQ(found.notes.size(), 1U);
}

TEST(IdentifyLoading, NeedsThreePushesAndNoLaw) {
  EXPECT_FALSE(assumed_after(2).parameters.contact_stiffness);
  ObjectParameters known;
  known.contact_stiffness = ParameterValue{1e4, 100.0};
  EXPECT_EQ(assumed_after(3, known).parameters.contact_stiffness->value, 1e4);
}

TEST(IdentifyLoading, AssumesNothingByPushesThatMoveTheObjectWhileTheyLoadIt) {
  std::vector<Contact> contacts;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) contacts.push_back(push_at(0.15, 0.97, seed));
  ObjectIdentification result;
  assume_contact_by_loading(contacts, 0, result);
  EXPECT_FALSE(result.parameters.contact_stiffness);
  EXPECT_TRUE(result.notes.empty());
}

TEST(IdentifyLoading, DoesNotReplaceALawThatIsWithheld) {
  std::vector<Contact> contacts{slow_push(1), slow_push(2), slow_push(3)};
  ObjectIdentification result;
  result.is_contact_off_centre = true;
  assume_contact_by_loading(contacts, 0, result);
  EXPECT_FALSE(result.parameters.contact_stiffness);
}

TEST(IdentifyLoading, IsReplacedByTheNextIdentification) {
  ObjectIdentification found = assumed_after(3);
  EXPECT_FALSE(is_contact_assumed(found.parameters));  // as one that was typed in
  found.parameters.sources.given.emplace_back("contact.stiffness");
  EXPECT_TRUE(is_contact_assumed(found.parameters));
  forget_contact(found.parameters);
  EXPECT_FALSE(found.parameters.contact_stiffness);
  EXPECT_TRUE(found.parameters.sources.given.empty());
}

}  // namespace
}  // namespace pcavr
