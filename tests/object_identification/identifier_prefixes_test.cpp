// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Contacts as they come, or all at once in any order: one answer.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/object_identification/object_identifier.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "pipeline/identified_case.hpp"

namespace pcavr {
namespace {

using Contacts = std::vector<std::shared_ptr<const ObservedContact>>;

constexpr double kMargin = 0.3;  // [s] of the path before and after a contact

/// The contacts of an object that `found` has, each as a site observes it.
Contacts observed(const IdentificationInput& input, const Identification& found,
                  std::size_t object) {
  Contacts contacts;
  for (const IdentifiedContact& contact : found.contacts) {
    if (contact.object != object) continue;
    auto one = std::make_shared<ObservedContact>();
    one->contact.episode = contact.episode;
    one->contact.object = contact.object;
    one->contact.force_base = contact.force_base;
    one->contact.left_out = contact.left_out;
    one->contact.normal_object = contact.normal_object;
    one->contact.lever = contact.lever;
    const auto is_near = [&](double t) {
      return t >= contact.episode.begin - kMargin && t <= contact.episode.end + kMargin;
    };
    const double from = contacts.empty() ? 0.0 : contacts.back()->t_tool.back();
    for (std::size_t i = 0; i < input.t_tool.size(); ++i) {
      if (!is_near(input.t_tool[i]) || input.t_tool[i] <= from) continue;
      one->t_tool.push_back(input.t_tool[i]);
      one->p_base_tip.push_back(input.p_base_tip[i]);
    }
    for (const TrackedPose& pose : input.objects[object].tracked) {
      if (is_near(pose.t) && pose.t > from) one->tracked.push_back(pose);
    }
    contacts.push_back(std::move(one));
  }
  return contacts;
}

/// Each parameter's value and std, as text with all digits.
std::string digits_of(const ObjectIdentification& found) {
  std::string text;
  for (const ParameterFinding& row : found.findings) {
    text += row.name + ' ' + std::to_string(row.is_excited);
    for (const double value : {row.value, row.std.value_or(-1.0)}) {
      text += ' ' + std::to_string(std::bit_cast<std::uint64_t>(value));
    }
    text += '\n';
  }
  return text;
}

class IdentifierPrefixes : public testing::TestWithParam<std::pair<ToolTask, std::uint64_t>> {};

TEST_P(IdentifierPrefixes, HaveOneAnswerInAnyOrder) {
  const auto [task, seed] = GetParam();
  const IdentifiedCase made = identified_case(task, seed, 120.0);
  const auto found = identify(made.input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  Random random(seed);
  const IdentifiableObject& object = made.input.objects[0];
  const auto start = [&] {
    return ObjectIdentifier(object, {}, made.input.tool_radius, IdentificationGoal::friction, {});
  };
  const Contacts contacts = observed(made.input, *found, 0);
  ASSERT_GT(contacts.size(), 3U);
  ObjectIdentifier one_by_one = start();
  for (std::size_t count = 1; count <= contacts.size(); ++count) {
    one_by_one.add(contacts[count - 1]);
    Contacts prefix(contacts.begin(), contacts.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::size_t i = prefix.size(); i > 1; --i) {
      std::swap(prefix[i - 1],
                prefix[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
    }
    ObjectIdentifier at_once = start();
    for (const auto& contact : prefix) at_once.add(contact);
    EXPECT_EQ(digits_of(one_by_one.result().object), digits_of(at_once.result().object))
        << "after " << count << " contacts";
  }
  EXPECT_NE(digits_of(one_by_one.result().object).find("limiting_static_friction 1"),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Tasks, IdentifierPrefixes,
                         testing::Values(std::pair{ToolTask::probe, 71U},
                                         std::pair{ToolTask::probe, 73U}));

}  // namespace
}  // namespace pcavr
