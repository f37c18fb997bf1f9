// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr::test {

/// One message of each type, in the order of their numbers.
inline std::vector<LinkMessage> every_message() {
  const LinkHeader header{17, 0xabcd1234, 98.5};
  LinkCommand command;
  command.t = 12.345;
  command.p_base_tip = {0.25F, -0.5F, 0.125F};
  command.is_engaged = true;
  command.acknowledged = {7, 5};
  command.correction_delay = 0.4375F;
  command.predictions = {
      {}, {{0.5F, 0.1F, -0.3F}, {1.0F, 2.0F, 3.0F}, {1.5F, 2.5F, 3.5F}, MotionPhase::sliding, 200}};
  LinkState state;
  state.t = 13.0;
  state.executed = 12.9;
  state.lead = 0.004F;
  state.limits = static_cast<std::uint32_t>(LinkLimit::force);
  state.is_on_hold = true;
  state.discarded_commands = 3;
  state.corrections = 9;
  state.tool_response = {2.5e-5, 80.0, 0.8, 1e-3, 1.5e-4};
  state.force_base = {0.0F, 4.0F, 0.5F};
  state.objects = {{{0.4F, 0.2F, 0.1F},
                    Eigen::Quaternionf::Identity(),
                    1e-4F,
                    0.03F,
                    MotionPhase::critical,
                    true}};
  return {
      {header, LinkHello{"0.1.0", "alice"}},
      {header, LinkWelcome{1.5, 0.01, false, "0.1.0", "two boxes", {"box_1", "box_2"}}},
      {header, LinkReject{LinkRejection::busy, "another operator is connected"}},
      {header, LinkPing{}},
      {header, LinkPong{1.25, 2.5}},
      {header, command},
      {header, state},
      {header, LinkCorrection{4, 11.25, 11.75, {1, 2, 3}}},
      {header, LinkAcknowledgement{4, 2}},
      {header, LinkHeartbeat{}},
      {header, LinkStop::emergency_stop},
      {header,
       LinkPicture{
           3.0,
           320,
           240,
           {0xff, 0xd8},
           LinkPictureCamera{
               300.0F, 301.0F, 159.5F, 119.5F, LensModel::fisheye, {0.1F, -0.2F, 0.01F, 0.002F}}}},
      {header, LinkPictureReceipt{18, 3.25}}};
}

}  // namespace pcavr::test
