// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/serve/live_protocol.hpp"

#include "link_wire.hpp"
#include "live_wire.hpp"
#include "server_wire.hpp"

namespace pcavr {
namespace {

void write_object(const LiveObject& object, ByteWriter& writer) {
  write_vector(object.position, writer);
  write_quaternion(object.orientation, writer);
  write_vector(object.force, writer);
  writer.integer(static_cast<std::uint8_t>(object.phase));
  writer.integer(static_cast<std::uint8_t>((object.is_outside_model ? 1 : 0) |
                                           (object.is_blocked ? 2 : 0) |
                                           (object.is_saturated ? 4 : 0)));
  writer.integer(std::uint16_t{0});
  writer.f32(object.speed);
}

std::uint32_t flags_of(const LiveState& state) {
  return (state.is_engaged ? kEngaged : 0U) | (state.is_on_hold ? kOnHold : 0U) |
         (state.touches_scan ? kTouchesScan : 0U) | (state.has_tool ? kHasTool : 0U) |
         (state.tool_taken ? kToolTaken : 0U) | (state.is_stopped ? kStopped : 0U) |
         (state.link ? kHasLink : 0U) | (state.can_undo_reset ? kCanUndoReset : 0U) |
         (state.is_tool_wanted ? kToolWanted : 0U) | (state.has_asked ? kHasAsked : 0U) |
         (state.is_recording ? kRecording : 0U) |
         static_cast<std::uint32_t>(std::lround(kPercents * state.time_scale)) << kTimeScaleShift;
}

/// The other link, the object, or kNoObject for the scan.
std::uint32_t other_of(const LiveArmState::Nearest& nearest) {
  return nearest.other_link.value_or(nearest.object.value_or(kNoObject));
}

void write_arm(const LiveArmState& arm, ByteWriter& writer) {
  const LiveArmState::Nearest nearest = arm.nearest.value_or(LiveArmState::Nearest{});
  writer.integer(static_cast<std::uint32_t>(arm.position.size()));
  writer.integer((arm.is_stopped ? kArmStopped : 0U) | (arm.is_reached ? kArmReached : 0U) |
                 (arm.nearest ? kArmHasNearest : 0U) | (nearest.other_link ? kArmNearItself : 0U));
  writer.f32(nearest.distance);
  writer.integer(nearest.link);
  writer.integer(other_of(nearest));
  for (const float position : arm.position) writer.f32(position);
}

void write_state(const LiveState& state, ByteWriter& writer) {
  writer.f64(state.t);
  writer.f64(state.page_clock);
  writer.integer(flags_of(state));
  writer.integer(static_cast<std::uint32_t>(state.touched_object.value_or(kNoObject)));
  write_vector(state.p_base_hip, writer);
  write_vector(state.p_base_proxy, writer);
  write_vector(state.force_base, writer);
  writer.f32(state.pulse);
  writer.integer(state.pulses);
  writer.integer(state.cycles);
  writer.integer(state.late_cycles);
  for (const float value : {state.cycle_median, state.cycle_p99, state.cycle_longest,
                            state.tool_age, state.state_age, state.queue_age}) {
    writer.f32(value);
  }
  writer.integer(static_cast<std::uint32_t>(state.objects.size()));
  for (const LiveObject& object : state.objects) write_object(object, writer);
  if (state.arm) write_arm(*state.arm, writer);
  if (state.link) write_link(*state.link, state.objects.size(), writer);
}

struct ServerBody {
  ByteWriter& writer;
  void operator()(const LiveWelcome& welcome) {
    write_text(json_text(nlohmann::ordered_json{{"protocol", welcome.protocol},
                                                {"version", welcome.version},
                                                {"mode", welcome.is_replay ? "replay" : "live"},
                                                {"scene", welcome.scene},
                                                {"objects", welcome.objects},
                                                {"tool_radius", welcome.tool_radius},
                                                {"rate", welcome.rate},
                                                {"device", welcome.device},
                                                {"can_record", welcome.can_record}}),
               writer);
  }
  void operator()(const LiveState& state) { write_state(state, writer); }
  void operator()(const LiveNotice& notice) {
    nlohmann::ordered_json json{{"level", kLevels[static_cast<std::size_t>(notice.level)]},
                                {"text", notice.text}};
    if (!notice.about.empty()) json["about"] = notice.about;
    write_text(json_text(json), writer);
  }
  void operator()(const LivePong& pong) { writer.f64(pong.clock); }
};

}  // namespace

std::vector<std::uint8_t> encode(const ServerMessage& message) {
  constexpr std::array kTypes{LiveType::welcome, LiveType::state, LiveType::notice, LiveType::pong};
  std::vector<std::uint8_t> bytes;
  write_frame(kTypes[message.content.index()], message.header, bytes,
              [&](ByteWriter& writer) { std::visit(ServerBody{writer}, message.content); });
  return bytes;
}

void encode_state(const LiveHeader& header, const LiveState& state,
                  std::vector<std::uint8_t>& bytes) {
  write_frame(LiveType::state, header, bytes,
              [&](ByteWriter& writer) { write_state(state, writer); });
}

}  // namespace pcavr
