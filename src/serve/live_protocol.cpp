// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/live_protocol.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include "pcavr/core/bytes.hpp"

#include "core/json_text.hpp"
#include "live_wire.hpp"

namespace pcavr {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::uint8_t, 4> kMagic{'P', 'C', 'V', 'R'};
constexpr std::size_t kHeadBytes = 24;
// A unit quaternion in single precision is one to 1e-6; what is farther off was never one.
constexpr float kNotAUnit = 1e-3F;
constexpr std::uint8_t kHands = 4;
// A number that is larger names no protocol.
constexpr std::uint64_t kMaxProtocol = 1'000'000;
constexpr std::uint32_t kCommands = 5;

Expected<PageMessage> read_hello(const LiveFrame& frame) {
  const auto json = ordered_json::parse(frame.body.begin(), frame.body.end(), nullptr, false);
  const std::optional<int> protocol = protocol_in(json);
  if (!protocol) return refused("the hello is not JSON with a whole number \"protocol\"");
  LiveHello hello{*protocol, {}};
  if (json.contains("version") && json["version"].is_string()) hello.version = json["version"];
  return PageMessage{frame.head, std::move(hello)};
}

Expected<PageMessage> read_tool(const LiveFrame& frame) {
  ByteReader reader(frame.body);
  LiveTool tool;
  tool.p_base_tip = read_vector(reader);
  tool.q_base_tool = read_quaternion(reader);
  const auto flags = reader.whole<std::uint8_t>();
  const auto hand = reader.whole<std::uint8_t>();
  const auto padding = reader.whole<std::uint16_t>();
  if (!reader.is_sound() || !reader.is_at_end()) return refused("a tool of another length");
  if (!tool.p_base_tip.allFinite() || !tool.q_base_tool.coeffs().allFinite()) {
    return refused("a tool that is not finite");
  }
  if (std::abs(tool.q_base_tool.norm() - 1.0F) > kNotAUnit) {
    return refused("a tool whose orientation is no unit quaternion");
  }
  if (flags > 1 || hand >= kHands || padding != 0) return refused("a tool of an unknown kind");
  tool.is_engaged = flags == 1;
  tool.hand = static_cast<LiveHand>(hand);
  return PageMessage{frame.head, tool};
}

Expected<PageMessage> read_command(const LiveFrame& frame) {
  ByteReader reader(frame.body);
  const auto command = reader.whole<std::uint32_t>();
  if (!reader.is_sound() || !reader.is_at_end() || command < 1 || command > kCommands) {
    return refused("an unknown command");
  }
  return PageMessage{frame.head, static_cast<LiveCommand>(command)};
}

struct PageBody {
  ByteWriter& writer;
  void operator()(const LiveTool& tool) {
    write_vector(tool.p_base_tip, writer);
    write_quaternion(tool.q_base_tool, writer);
    writer.whole(static_cast<std::uint8_t>(tool.is_engaged ? 1 : 0));
    writer.whole(static_cast<std::uint8_t>(tool.hand));
    writer.whole(std::uint16_t{0});
  }
  void operator()(const LiveCommand& command) { writer.whole(static_cast<std::uint32_t>(command)); }
  void operator()(const LivePing&) {}
  void operator()(const LiveHello& hello) {
    write_text(json_text({{"protocol", hello.protocol}, {"version", hello.version}}), writer);
  }
};

}  // namespace

Error refused(std::string why) { return Error{.message = std::move(why), .place = "message"}; }

std::optional<int> protocol_in(const ordered_json& json) {
  if (!json.is_object() || !json.contains("protocol")) return std::nullopt;
  const ordered_json& protocol = json["protocol"];
  if (!protocol.is_number_unsigned() || protocol.get<std::uint64_t>() > kMaxProtocol) {
    return std::nullopt;
  }
  return protocol.get<int>();
}

Expected<LiveFrame> read_frame(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kLiveMostBytes) return refused("longer than 64 KiB");
  ByteReader reader(bytes);
  for (const std::uint8_t letter : kMagic) {
    if (reader.whole<std::uint8_t>() != letter) return refused("it does not begin with PCVR");
  }
  LiveFrame frame;
  const auto version = reader.whole<std::uint8_t>();
  frame.type = reader.whole<std::uint8_t>();
  const auto padding = reader.whole<std::uint16_t>();
  frame.head.sequence = reader.whole<std::uint32_t>();
  const auto length = reader.whole<std::uint32_t>();
  frame.head.clock = reader.f64();
  frame.body = reader.rest();
  if (!reader.is_sound()) return refused("shorter than its head");
  if (version != kLiveProtocol) {
    return refused("protocol " + std::to_string(version) + " where the server speaks " +
                   std::to_string(kLiveProtocol));
  }
  if (padding != 0 || frame.head.sequence == 0 || !std::isfinite(frame.head.clock)) {
    return refused("its head is not sound");
  }
  if (length != frame.body.size()) return refused("its length is not what its head says");
  return frame;
}

void write_frame(LiveType type, const LiveHead& head, std::vector<std::uint8_t>& bytes,
                 const std::function<void(ByteWriter&)>& write_body) {
  bytes.clear();
  ByteWriter writer(bytes);
  for (const std::uint8_t letter : kMagic) writer.whole(letter);
  writer.whole(static_cast<std::uint8_t>(kLiveProtocol));
  writer.whole(static_cast<std::uint8_t>(type));
  writer.whole(std::uint16_t{0});
  writer.whole(head.sequence);
  writer.whole(std::uint32_t{0});
  writer.f64(head.clock);
  write_body(writer);
  const std::size_t length = bytes.size() - kHeadBytes;
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[12 + i] = static_cast<std::uint8_t>(length >> (8 * i));
  }
}

Expected<PageMessage> decode_page_message(std::span<const std::uint8_t> bytes) {
  const Expected<LiveFrame> frame = read_frame(bytes);
  if (!frame) return frame.error();
  switch (static_cast<LiveType>(frame->type)) {
    case LiveType::hello:
      return read_hello(*frame);
    case LiveType::tool:
      return read_tool(*frame);
    case LiveType::command:
      return read_command(*frame);
    case LiveType::ping:
      if (!frame->body.empty()) return refused("a ping that says something");
      return PageMessage{frame->head, LivePing{}};
    default:
      return refused("type " + std::to_string(frame->type) + " is none that a page sends");
  }
}

std::vector<std::uint8_t> encode(const PageMessage& message) {
  constexpr std::array kTypes{LiveType::hello, LiveType::tool, LiveType::command, LiveType::ping};
  std::vector<std::uint8_t> bytes;
  write_frame(kTypes[message.content.index()], message.head, bytes,
              [&](ByteWriter& writer) { std::visit(PageBody{writer}, message.content); });
  return bytes;
}

}  // namespace pcavr
