// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "link_wire.hpp"

#include <limits>

#include "pcavr/base/core/check.hpp"

#include "live_wire.hpp"
#include "server_wire.hpp"

namespace pcavr {
namespace {

std::uint32_t link_flags_of(const LiveLinkState& link) {
  return (link.is_connected ? kConnected : 0U) | (link.robot ? kHasRobot : 0U) |
         (link.robot && link.robot->is_on_hold ? kRobotOnHold : 0U) |
         (link.robot && link.robot->is_stopped ? kRobotStopped : 0U) |
         (link.delays ? kHasDelays : 0U);
}

}  // namespace

void write_link(const LiveLinkState& link, std::size_t objects, ByteWriter& writer) {
  LiveLinkState::Robot robot = link.robot.value_or(LiveLinkState::Robot{});
  if (!link.robot) robot.objects.resize(objects);
  PCAVR_REQUIRE(robot.objects.size() == objects, robot.objects.size(), objects);
  writer.integer(link_flags_of(link));
  writer.integer(robot.limits);
  writer.integer(robot.corrections);
  for (const float value : {link.silence, link.lead, link.round_trip, link.clock_std}) {
    writer.f32(value);
  }
  write_vector(robot.p_base_tip, writer);
  write_vector(robot.force_base, writer);
  const DelayStamps stamps = link.delays.value_or(DelayStamps{});
  writer.f64(stamps.device_clock.value_or(std::numeric_limits<double>::quiet_NaN()));
  for (const double stamp : {stamps.sent, stamps.received, stamps.applied, stamps.sensed,
                             stamps.sent_back, stamps.received_back}) {
    writer.f64(stamp);
  }
  writer.integer(link.picture);
  writer.f32(link.picture_age);
  for (const LiveLinkState::Object& object : robot.objects) {
    write_vector(object.position, writer);
    write_quaternion(object.orientation, writer);
    writer.f32(object.age);
    writer.integer(std::uint32_t{object.is_tracked ? 1U : 0U});
  }
}

}  // namespace pcavr
