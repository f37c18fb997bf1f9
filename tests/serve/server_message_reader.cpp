// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "serve/server_message_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "serve/live_wire.hpp"
#include "serve/server_wire.hpp"

namespace pcavr {
namespace {

using nlohmann::ordered_json;

constexpr std::uint8_t kPhases = 4;
constexpr std::size_t kObjectBytes = 48;
constexpr std::size_t kArmBytes = 20;    // before the joints' positions
constexpr std::size_t kLinkBytes = 116;  // before the objects
constexpr std::size_t kLinkObjectBytes = 36;

LiveObject read_object(ByteReader& reader) {
  LiveObject object;
  object.position = read_vector(reader);
  object.orientation = read_quaternion(reader);
  object.force = read_vector(reader);
  const auto phase = reader.integer<std::uint8_t>();
  object.phase = static_cast<MotionPhase>(phase < kPhases ? phase : 0);
  const auto flags = reader.integer<std::uint8_t>();
  object.is_outside_model = (flags & 1U) != 0;
  object.is_blocked = (flags & 2U) != 0;
  object.is_saturated = (flags & 4U) != 0;
  (void)reader.integer<std::uint16_t>();
  object.speed = reader.f32();
  return object;
}

/// Reads an arm from the next `bytes`; nothing if they are not exactly an arm.
std::optional<LiveArmState> read_arm(ByteReader& reader, std::size_t bytes) {
  LiveArmState arm;
  const auto count = reader.integer<std::uint32_t>();
  if (bytes != kArmBytes + 4 * std::size_t{count}) return std::nullopt;
  arm.position.resize(count);
  const auto flags = reader.integer<std::uint32_t>();
  arm.is_stopped = (flags & kArmStopped) != 0;
  arm.is_reached = (flags & kArmReached) != 0;
  LiveArmState::Nearest nearest{reader.f32(), reader.integer<std::uint32_t>(), {}, {}};
  const auto other = reader.integer<std::uint32_t>();
  if ((flags & kArmNearItself) != 0) nearest.other_link = other;
  if ((flags & kArmNearItself) == 0 && other != kNoObject) nearest.object = other;
  if ((flags & kArmHasNearest) != 0) arm.nearest = nearest;
  for (float& position : arm.position) position = reader.f32();
  return arm;
}

std::size_t link_bytes_of(std::size_t objects) { return kLinkBytes + kLinkObjectBytes * objects; }

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

void read_flags(std::uint32_t flags, LiveState& state) {
  state.is_engaged = (flags & kEngaged) != 0;
  state.is_on_hold = (flags & kOnHold) != 0;
  state.touches_scan = (flags & kTouchesScan) != 0;
  state.has_tool = (flags & kHasTool) != 0;
  state.tool_taken = (flags & kToolTaken) != 0;
  state.is_stopped = (flags & kStopped) != 0;
  state.can_undo_reset = (flags & kCanUndoReset) != 0;
  state.is_tool_wanted = (flags & kToolWanted) != 0;
  state.has_asked = (flags & kHasAsked) != 0;
  state.is_recording = (flags & kRecording) != 0;
  state.time_scale = (flags >> kTimeScaleShift & 0xffU) / kPercents;
}

Expected<ServerMessage> read_state(const LiveFrame& frame) {
  ByteReader reader(frame.body);
  LiveState state;
  state.t = reader.f64();
  state.page_clock = reader.f64();
  const auto flags = reader.integer<std::uint32_t>();
  read_flags(flags, state);
  const auto touched = reader.integer<std::uint32_t>();
  if (touched != kNoObject) state.touched_object = touched;
  state.p_base_hip = read_vector(reader);
  state.p_base_proxy = read_vector(reader);
  state.force_base = read_vector(reader);
  state.pulse = reader.f32();
  state.pulses = reader.integer<std::uint32_t>();
  state.cycles = reader.integer<std::uint32_t>();
  state.late_cycles = reader.integer<std::uint32_t>();
  for (float* value : {&state.cycle_median, &state.cycle_p99, &state.cycle_longest, &state.tool_age,
                       &state.state_age, &state.queue_age}) {
    *value = reader.f32();
  }
  const auto count = reader.integer<std::uint32_t>();
  if (!reader.is_valid() || reader.rest().size() < std::size_t{count} * kObjectBytes) {
    return invalid_message("a state has the wrong length");
  }
  state.objects.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) state.objects.push_back(read_object(reader));
  const bool has_link = (flags & kHasLink) != 0;
  const std::size_t link_bytes = has_link ? link_bytes_of(count) : 0;
  const std::size_t rest = reader.rest().size();
  if (rest < link_bytes) return invalid_message("a state has the wrong length");
  const bool has_arm = rest > link_bytes;
  if (has_arm) state.arm = read_arm(reader, rest - link_bytes);
  if (has_arm && !state.arm) {
    return invalid_message("a state has the wrong length");
  }
  if (has_link) state.link = read_link(reader, count);
  return ServerMessage{frame.header, std::move(state)};
}

Expected<ServerMessage> read_notice(const LiveFrame& frame, const ordered_json& json) {
  if (!json.contains("level") || !json.contains("text") || !json["text"].is_string()) {
    return invalid_message("a notice has no level or text");
  }
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    if (json["level"] != kLevels[i]) continue;
    LiveNotice notice{static_cast<LiveLevel>(i), json["text"]};
    if (json.contains("about") && json["about"].is_string()) notice.about = json["about"];
    return ServerMessage{frame.header, std::move(notice)};
  }
  return invalid_message("a notice has an unknown level");
}

Expected<ServerMessage> read_welcome(const LiveFrame& frame, const ordered_json& json) {
  const auto has = [&](const char* key, auto is_valid) {
    return json.contains(key) && is_valid(json[key]);
  };
  const auto text = [](const ordered_json& value) { return value.is_string(); };
  const auto number = [](const ordered_json& value) { return value.is_number(); };
  const auto names = [](const ordered_json& value) {
    return value.is_array() && std::all_of(value.begin(), value.end(),
                                           [](const auto& name) { return name.is_string(); });
  };
  const std::optional<int> protocol = protocol_in(json);
  if (!protocol || !has("version", text) || !has("mode", text) || !has("scene", text) ||
      !has("objects", names) || !has("tool_radius", number) || !has("rate", number) ||
      !has("device", text)) {
    return invalid_message("a welcome lacks a field");
  }
  const bool can_record = json.contains("can_record") && json["can_record"] == true;
  LiveWelcome welcome{*protocol,     json["version"], json["mode"] == "replay",
                      json["scene"], json["objects"], json["tool_radius"],
                      json["rate"],  json["device"],  can_record};
  return ServerMessage{frame.header, std::move(welcome)};
}

}  // namespace

Expected<ServerMessage> decode_server_message(std::span<const std::uint8_t> bytes) {
  const Expected<LiveFrame> frame = read_frame(bytes);
  if (!frame) return frame.error();
  const auto type = static_cast<LiveType>(frame->type);
  if (type == LiveType::state) return read_state(*frame);
  if (type == LiveType::pong) {
    ByteReader reader(frame->body);
    const double clock = reader.f64();
    if (!reader.is_valid() || !reader.is_at_end())
      return invalid_message("a pong has the wrong length");
    return ServerMessage{frame->header, LivePong{clock}};
  }
  if (type != LiveType::welcome && type != LiveType::notice) {
    return invalid_message("type " + std::to_string(frame->type) +
                           " is not one that a server sends");
  }
  const auto json = ordered_json::parse(frame->body.begin(), frame->body.end(), nullptr, false);
  if (!json.is_object()) return invalid_message("its body is not a JSON object");
  return type == LiveType::notice ? read_notice(*frame, json) : read_welcome(*frame, json);
}

}  // namespace pcavr
