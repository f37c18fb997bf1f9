// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "teleop/object_learner.hpp"

namespace pcavr {

/// Learns from a contact as the robot's site does, which searches for its friction apart.
inline void learn_with_friction(ObjectLearner& learner, const ContactRecord& record, double begin,
                                const ObjectLearner::ContactFacts& facts) {
  learner.learn(record, begin, facts);
  if (const std::optional<FrictionSearch> search = learner.next_search())
    learner.accept(search->run());
}

}  // namespace pcavr
