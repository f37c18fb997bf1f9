// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "support/meshes.hpp"
#include "teleoperation/teleop/online_identification.hpp"

namespace pcavr {

/// Knowledge of a box of 0.1 m by 0.1 m by 0.05 m about the origin, before its first contact.
inline OnlineIdentification knowledge_of_box(const ObjectParameters& given,
                                             const LearningOptions& options = {}) {
  auto box = std::make_shared<IdentifiableObject>(IdentifiableObject{
      .name = "box",
      .model = make_cad_model(test::box_mesh({0.1F, 0.1F, 0.05F}), "box", "test").value(),
      .T_base_object = Pose()});
  return OnlineIdentification(std::move(box), given, 0.01, options);
}

/// Learns from a contact as the robot's site does, which searches for its friction apart.
inline void learn_with_friction(OnlineIdentification& knowledge, const ContactSamples& contact) {
  knowledge.learn(contact);
  if (const std::optional<ObjectIdentifier> search = knowledge.next_search())
    knowledge.accept(search->result());
}

}  // namespace pcavr
