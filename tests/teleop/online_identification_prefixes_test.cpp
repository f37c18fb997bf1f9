// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The robot's site has the values of `pcavr identify` for the contacts that it has had.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/inputs/input_monitor.hpp"

#include "object_identification/contacts_with_motion.hpp"
#include "teleop/plant_input.hpp"
#include "teleoperation/teleop/online_identification.hpp"

namespace pcavr {
namespace {

/// The first contacts with the first object, as `pcavr identify` finds them.
Contacts contacts_in(const TeleopInput& input) {
  constexpr std::size_t kContacts = 9;
  InputSeries series{.tool_radius = input.tool_radius,
                     .t_tool = input.t_tool,
                     .p_base_tip = input.p_base_tip,
                     .q_base_tool = {},
                     .t_force = input.t_force,
                     .force_base = input.force_base};
  for (const TeleopObject& object : input.objects) {
    series.bodies.push_back(
        {object.name, &object.model, object.T_base_object, {}, object.tracked, true});
  }
  std::vector<Contact> found;
  static_cast<void>(
      examine_inputs(series, {}, [&](Contact&& one) { found.push_back(std::move(one)); }));
  Contacts contacts =
      with_motion(found, 0, input.t_tool, input.p_base_tip, input.objects[0].tracked);
  contacts.resize(std::min(contacts.size(), kContacts));
  return contacts;
}

using Field = std::optional<ParameterValue> ObjectParameters::*;

/// Whether values are the same to the last digit, also of their stds.
bool are_same(const ObjectParameters& a, const ObjectParameters& b,
              const std::vector<Field>& fields) {
  return std::ranges::all_of(fields, [&](Field field) {
    const auto& one = a.*field;
    const auto& other = b.*field;
    if (one.has_value() != other.has_value()) return false;
    return !one || (one->value == other->value && one->std == other->std);
  });
}

/// Every value that the site uses comes from what `identify` finds in the contacts up to some time,
/// to the last digit; values that belong together, from the same contacts. The mass and the contact
/// law's damping are among them.
TEST(OnlineIdentificationPrefixes, HaveTheResultOfIdentify) {
  const std::vector<Field> law{&ObjectParameters::contact_stiffness,
                               &ObjectParameters::contact_exponent,
                               &ObjectParameters::contact_damping};
  const std::vector<Field> friction{&ObjectParameters::mass,
                                    &ObjectParameters::sliding_friction_coefficient,
                                    &ObjectParameters::viscous_friction};
  const std::vector<Field> limit{&ObjectParameters::limiting_static_friction};
  const TeleopInput input = plant_input(71, false, {}, ToolTask::probe).input;
  const auto object = std::make_shared<IdentifiableObject>(
      IdentifiableObject{.name = input.objects[0].name,
                         .model = input.objects[0].model,
                         .T_base_object = input.objects[0].T_base_object});
  const Contacts contacts = contacts_in(input);
  ASSERT_GT(contacts.size(), 3U);
  const ObjectParameters& weighed = input.objects[0].parameters;
  ObjectParameters too_heavy = weighed;
  too_heavy.mass->value *= 2.0;
  for (const ObjectParameters& given : {ObjectParameters(), weighed, too_heavy}) {
    Random random(7);
    LearningOptions options;
    options.max_fitted_contacts = 20;
    OnlineIdentification knowledge(object, given, input.tool_radius, options);
    std::vector<ObjectParameters> results;
    for (const auto& contact : contacts) {
      knowledge.add(contact, !contact->slides.empty());
      ObjectIdentifier identifier(*object, given, input.tool_radius, IdentificationGoal::friction,
                                  {});
      for (const auto& one :
           shuffled({contacts.begin(), contacts.begin() + std::ssize(results) + 1}, random))
        identifier.add(one);
      const ObjectIdentification all = identifier.result().object;
      results.push_back(all.parameters);
      const std::optional<ObjectIdentifier> search = knowledge.next_search();
      if (!search) continue;  // no push has slid
      const ObjectIdentifier::Result result = search->result();
      EXPECT_EQ(digits_of(result.object), digits_of(all)) << "after contact " << results.size();
      knowledge.accept(result);
      for (const auto& fields : {law, friction, limit}) {
        EXPECT_TRUE(std::ranges::any_of(
            results,
            [&](const ObjectParameters& one) { return are_same(knowledge.known(), one, fields); }))
            << "after contact " << results.size();
      }
    }
    for (const auto& fields : {law, friction, limit})
      EXPECT_TRUE(are_same(knowledge.known(), results.back(), fields));
    EXPECT_TRUE(knowledge.known().contact_damping);
  }
}

}  // namespace
}  // namespace pcavr
