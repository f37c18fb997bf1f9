// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "link_wire.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "pcavr/base/core/check.hpp"

#include "live_wire.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kLinkBytes = 116;  ///< before the objects
constexpr std::size_t kLinkObjectBytes = 36;

enum LinkFlag : std::uint32_t {
  kConnected = 1,
  kHasRobot = 2,
  kRobotOnHold = 4,
  kRobotStopped = 8,
  kHasDelays = 16,
};

std::uint32_t link_flags_of(const LiveLinkState& link) {
  return (link.is_connected ? kConnected : 0U) | (link.robot ? kHasRobot : 0U) |
         (link.robot && link.robot->is_on_hold ? kRobotOnHold : 0U) |
         (link.robot && link.robot->is_stopped ? kRobotStopped : 0U) |
         (link.delays ? kHasDelays : 0U);
}

}  // namespace

std::size_t link_bytes_of(std::size_t objects) { return kLinkBytes + kLinkObjectBytes * objects; }

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

LiveLinkState read_link(ByteReader& reader, std::size_t objects) {
  LiveLinkState link;
  LiveLinkState::Robot robot;
  const auto flags = reader.integer<std::uint32_t>();
  link.is_connected = (flags & kConnected) != 0;
  robot.is_on_hold = (flags & kRobotOnHold) != 0;
  robot.is_stopped = (flags & kRobotStopped) != 0;
  robot.limits = reader.integer<std::uint32_t>();
  robot.corrections = reader.integer<std::uint32_t>();
  for (float* value : {&link.silence, &link.lead, &link.round_trip, &link.clock_std}) {
    *value = reader.f32();
  }
  robot.p_base_tip = read_vector(reader);
  robot.force_base = read_vector(reader);
  DelayStamps stamps;
  const double device_clock = reader.f64();
  if (!std::isnan(device_clock)) stamps.device_clock = device_clock;
  for (double* stamp : {&stamps.sent, &stamps.received, &stamps.applied, &stamps.sensed,
                        &stamps.sent_back, &stamps.received_back}) {
    *stamp = reader.f64();
  }
  if ((flags & kHasDelays) != 0) link.delays = stamps;
  link.picture = reader.integer<std::uint32_t>();
  link.picture_age = reader.f32();
  for (std::size_t i = 0; i < objects; ++i) {
    LiveLinkState::Object& object = robot.objects.emplace_back();
    object.position = read_vector(reader);
    object.orientation = read_quaternion(reader);
    object.age = reader.f32();
    object.is_tracked = reader.integer<std::uint32_t>() != 0;
  }
  if ((flags & kHasRobot) != 0) link.robot = std::move(robot);
  return link;
}

}  // namespace pcavr
