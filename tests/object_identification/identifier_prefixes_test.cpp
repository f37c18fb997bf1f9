// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Contacts as they come, or all at once in any order: one answer.
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

#include "object_identification/contacts_with_motion.hpp"
#include "pipeline/identified_case.hpp"

namespace pcavr {
namespace {

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
  const Contacts contacts =
      with_motion(found->contacts, 0, made.input.t_tool, made.input.p_base_tip, object.tracked);
  ASSERT_GT(contacts.size(), 3U);
  ObjectIdentifier one_by_one = start();
  for (std::size_t count = 1; count <= contacts.size(); ++count) {
    one_by_one.add(contacts[count - 1]);
    const Contacts prefix =
        shuffled({contacts.begin(), contacts.begin() + static_cast<std::ptrdiff_t>(count)}, random);
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
