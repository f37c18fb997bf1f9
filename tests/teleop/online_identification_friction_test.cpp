// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What the robot's site learns contact by contact is what `identify` finds in the recording.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/pipeline/identify.hpp"

#include "pipeline/identified_case.hpp"
#include "teleop/learned_friction.hpp"

namespace pcavr {
namespace {

constexpr double kBefore = 0.3;  // [s] recorded with a contact, as by the robot's site
constexpr double kAfter = 0.3;   // [s]

template <typename T>
std::vector<T> part(const std::vector<double>& t, const std::vector<T>& values, double from,
                    double to) {
  const auto first = std::lower_bound(t.begin(), t.end(), from) - t.begin();
  const auto last = std::upper_bound(t.begin(), t.end(), to) - t.begin();
  return {values.begin() + first, values.begin() + last};
}

/// An object as the robot's site identifies it: its mass is given as a parameter.
std::shared_ptr<const IdentifiableObject> identifiable(const IdentifiableObject& object) {
  return std::make_shared<const IdentifiableObject>(
      IdentifiableObject{.name = object.name,
                         .model = object.model,
                         .T_base_object = object.T_base_object,
                         .is_movable = object.is_movable});
}

/// Learns an object from the contacts that `identify` uses, one after the other.
ObjectParameters learned(const IdentificationInput& input, const Identification& found,
                         std::size_t index, LearningOptions options = {}) {
  const IdentifiableObject& object = input.objects[index];
  ObjectParameters given;
  if (object.mass) given.mass = ParameterValue{*object.mass};
  options.max_fitted_contacts = 20;
  OnlineIdentification knowledge(identifiable(object), given, input.tool_radius, options);
  for (const Contact& contact : found.contacts) {
    if (contact.object != index || !contact.left_out.empty()) continue;
    const double from = contact.begin - kBefore;
    const double to = contact.end + kAfter;
    ContactSamples record{part(input.t_force, input.t_force, from, to),
                          part(input.t_force, input.force_base, from, to),
                          part(input.t_tool, input.t_tool, from, to),
                          part(input.t_tool, input.p_base_tip, from, to),
                          {},
                          contact.begin,
                          {.has_slid = !contact.slides.empty()}};
    for (const TrackedPose& pose : object.tracked) {
      if (pose.t >= from && pose.t <= to) record.tracked.push_back(pose);
    }
    learn_with_friction(knowledge, record);
  }
  return knowledge.known();
}

/// Each alone sees a bias of the force that is taken off, which differs by less than a std.
void expect_same(const std::optional<ParameterValue>& online,
                 const std::optional<ParameterValue>& offline, const std::string& what) {
  ASSERT_TRUE(offline && offline->std) << what;
  ASSERT_TRUE(online && online->std) << what;
  testing::Test::RecordProperty(
      what, std::to_string(online->value) + " +- " + std::to_string(*online->std) + ", identify: " +
                std::to_string(offline->value) + " +- " + std::to_string(*offline->std));
  EXPECT_NEAR(online->value, offline->value, 0.25 * *offline->std) << what;
  EXPECT_NEAR(*online->std / *offline->std, 1.0, 0.2) << what;
}

TEST(OnlineIdentificationFriction, FindsWhatIdentifyFindsInTheSameContacts) {
  for (const std::uint64_t seed : {71U, 72U, 73U}) {
    const IdentifiedCase made = identified_case(ToolTask::probe, seed, 600.0);
    const auto found = identify(made.input, IdentificationGoal::friction);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
      const ObjectParameters online = learned(made.input, *found, i);
      const ObjectParameters& offline = found->objects[i].parameters;
      const std::string at = " of box " + std::to_string(i) + ", seed " + std::to_string(seed);
      expect_same(online.limiting_static_friction, offline.limiting_static_friction, "F_M" + at);
      expect_same(online.sliding_friction_coefficient, offline.sliding_friction_coefficient,
                  "mu" + at);
      expect_same(online.viscous_friction, offline.viscous_friction, "B" + at);
      expect_same(online.contact_stiffness, offline.contact_stiffness, "stiffness" + at);
      expect_same(online.contact_exponent, offline.contact_exponent, "exponent" + at);
    }
  }
}

TEST(OnlineIdentificationFriction, UsesALawOfPressesThatIsTooUncertainToBeFelt) {
  const IdentifiedCase made = identified_case(ToolTask::probe, 71, 600.0);
  const auto found = identify(made.input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  LearningOptions options;
  options.max_fit_error = 0.0;
  for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
    const ObjectParameters online = learned(made.input, *found, i, options);
    EXPECT_FALSE(online.contact_stiffness);
    expect_same(online.limiting_static_friction,
                found->objects[i].parameters.limiting_static_friction,
                "F_M of box " + std::to_string(i));
  }
}

}  // namespace
}  // namespace pcavr
