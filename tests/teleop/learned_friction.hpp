// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "teleoperation/teleop/online_identification.hpp"

namespace pcavr {

/// Learns from a contact as the robot's site does, which searches for its friction apart.
inline void learn_with_friction(OnlineIdentification& knowledge, const ContactRecord& record,
                                double begin, const OnlineIdentification::ContactFacts& facts) {
  knowledge.learn(record, begin, facts);
  if (const std::optional<FrictionSearch> search = knowledge.next_search())
    knowledge.accept(search->run());
}

}  // namespace pcavr
