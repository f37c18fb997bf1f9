// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/serve/live_protocol.hpp"

#include "link_wire.hpp"
#include "live_wire.hpp"

namespace pcavr {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::string_view, 3> kLevels{"info", "warning", "error"};
constexpr std::size_t kObjectBytes = 48;
constexpr std::uint8_t kPhases = 4;
constexpr unsigned kTimeScaleShift = 8;  // bits of the flags below it
constexpr double kPercents = 100.0;

enum StateFlag : std::uint32_t {
  kEngaged = 1,
  kOnHold = 2,
  kTouchesScan = 4,
  kHasTool = 8,
  kToolTaken = 16,
  kStopped = 32,
  kHasLink = 64,
  kCanUndoReset = 128,
  kToolWanted = 1U << 16U,
  kHasAsked = 1U << 17U,
  kRecording = 1U << 18U,
};

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

constexpr std::uint32_t kNoObject = 0xffff'ffff;

std::uint32_t flags_of(const LiveState& state) {
  return (state.is_engaged ? kEngaged : 0U) | (state.is_on_hold ? kOnHold : 0U) |
         (state.touches_scan ? kTouchesScan : 0U) | (state.has_tool ? kHasTool : 0U) |
         (state.tool_taken ? kToolTaken : 0U) | (state.is_stopped ? kStopped : 0U) |
         (state.link ? kHasLink : 0U) | (state.can_undo_reset ? kCanUndoReset : 0U) |
         (state.is_tool_wanted ? kToolWanted : 0U) | (state.has_asked ? kHasAsked : 0U) |
         (state.is_recording ? kRecording : 0U) |
         static_cast<std::uint32_t>(std::lround(kPercents * state.time_scale)) << kTimeScaleShift;
}

constexpr std::uint32_t kArmStopped = 1;
constexpr std::uint32_t kArmReached = 2;
constexpr std::uint32_t kArmHasNearest = 4;
constexpr std::uint32_t kArmNearItself = 8;
constexpr std::size_t kArmBytes = 20;  ///< before the joints' positions

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

void read_flags(std::uint32_t flags, LiveState& state) {
  state.is_engaged = (flags & kEngaged) != 0;
  state.is_on_hold = (flags & kOnHold) != 0;
  state.touches_scan = (flags & kTouchesScan) != 0;
  state.has_tool = (flags & kHasTool) != 0;
  state.tool_taken = (flags & kToolTaken) != 0;
  state.is_stopped = (flags & kStopped) != 0;
  if ((flags & kHasLink) != 0) state.link.emplace();
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
  read_flags(reader.integer<std::uint32_t>(), state);
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
  const std::size_t link_bytes = state.link ? link_bytes_of(count) : 0;
  const std::size_t rest = reader.rest().size();
  if (rest < link_bytes) return invalid_message("a state has the wrong length");
  const bool has_arm = rest > link_bytes;
  if (has_arm) state.arm = read_arm(reader, rest - link_bytes);
  if (has_arm && !state.arm) {
    return invalid_message("a state has the wrong length");
  }
  if (state.link) state.link = read_link(reader, count);
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
