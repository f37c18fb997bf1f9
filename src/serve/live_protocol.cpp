// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/live_protocol.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/base/core/json_text.hpp"

#include "live_wire.hpp"

namespace pcavr {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::uint8_t, 4> kMagic{'P', 'C', 'V', 'R'};
constexpr std::size_t kHeaderBytes = 24;
// A unit quaternion in single precision has norm 1 to 1e-6; the rest is margin.
constexpr float kMaxNormError = 1e-3F;
constexpr std::uint8_t kInputDevices = 4;
// Larger numbers are not protocol versions.
constexpr std::uint64_t kMaxProtocol = 1'000'000;
constexpr auto kCommands = static_cast<std::uint32_t>(LiveCommand::stop_recording);

Expected<PageMessage> read_hello(const LiveFrame& frame) {
  const auto json = ordered_json::parse(frame.body.begin(), frame.body.end(), nullptr, false);
  const std::optional<int> protocol = protocol_in(json);
  if (!protocol) return invalid_message("the hello is not JSON with an integer \"protocol\"");
  LiveHello hello{*protocol, {}};
  if (json.contains("version") && json["version"].is_string()) hello.version = json["version"];
  return PageMessage{frame.header, std::move(hello)};
}

Expected<PageMessage> read_tool(const LiveFrame& frame) {
  ByteReader reader(frame.body);
  LiveTool tool;
  tool.p_base_tip = read_vector(reader);
  tool.q_base_tool = read_quaternion(reader);
  const auto flags = reader.integer<std::uint8_t>();
  const auto device = reader.integer<std::uint8_t>();
  const auto padding = reader.integer<std::uint16_t>();
  if (!reader.is_valid() || !reader.is_at_end())
    return invalid_message("a tool has the wrong length");
  if (!tool.p_base_tip.allFinite() || !tool.q_base_tool.coeffs().allFinite()) {
    return invalid_message("a tool has a number that is not finite");
  }
  if (std::abs(tool.q_base_tool.norm() - 1.0F) > kMaxNormError) {
    return invalid_message("a tool's orientation is not a unit quaternion");
  }
  if (flags > 1 || device >= kInputDevices || padding != 0)
    return invalid_message("a tool has unknown flags or an unknown device");
  tool.is_engaged = flags == 1;
  tool.device = static_cast<LiveInputDevice>(device);
  return PageMessage{frame.header, tool};
}

Expected<PageMessage> read_command(const LiveFrame& frame) {
  ByteReader reader(frame.body);
  const auto command = reader.integer<std::uint32_t>();
  if (!reader.is_valid() || !reader.is_at_end() || command < 1 || command > kCommands) {
    return invalid_message("unknown command");
  }
  return PageMessage{frame.header, static_cast<LiveCommand>(command)};
}

struct PageBody {
  ByteWriter& writer;
  void operator()(const LiveTool& tool) {
    write_vector(tool.p_base_tip, writer);
    write_quaternion(tool.q_base_tool, writer);
    writer.integer(static_cast<std::uint8_t>(tool.is_engaged ? 1 : 0));
    writer.integer(static_cast<std::uint8_t>(tool.device));
    writer.integer(std::uint16_t{0});
  }
  void operator()(const LiveCommand& command) {
    writer.integer(static_cast<std::uint32_t>(command));
  }
  void operator()(const LivePing&) {}
  void operator()(const LiveHello& hello) {
    write_text(
        json_text(nlohmann::ordered_json{{"protocol", hello.protocol}, {"version", hello.version}}),
        writer);
  }
};

}  // namespace

Error invalid_message(std::string reason) {
  return Error{.message = std::move(reason), .place = "message"};
}

std::optional<int> protocol_in(const ordered_json& json) {
  if (!json.is_object() || !json.contains("protocol")) return std::nullopt;
  const ordered_json& protocol = json["protocol"];
  if (!protocol.is_number_unsigned() || protocol.get<std::uint64_t>() > kMaxProtocol) {
    return std::nullopt;
  }
  return protocol.get<int>();
}

Expected<LiveFrame> read_frame(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kMaxLiveMessageBytes) return invalid_message("it exceeds 64 KiB");
  ByteReader reader(bytes);
  for (const std::uint8_t letter : kMagic) {
    if (reader.integer<std::uint8_t>() != letter)
      return invalid_message("it does not begin with PCVR");
  }
  LiveFrame frame;
  const auto version = reader.integer<std::uint8_t>();
  frame.type = reader.integer<std::uint8_t>();
  const auto padding = reader.integer<std::uint16_t>();
  frame.header.sequence = reader.integer<std::uint32_t>();
  const auto length = reader.integer<std::uint32_t>();
  frame.header.clock = reader.f64();
  frame.body = reader.rest();
  if (!reader.is_valid()) return invalid_message("it is shorter than its header");
  if (version != kLiveProtocolVersion) {
    return invalid_message("protocol " + std::to_string(version) + ", expected " +
                           std::to_string(kLiveProtocolVersion));
  }
  if (padding != 0 || frame.header.sequence == 0 || !std::isfinite(frame.header.clock)) {
    return invalid_message("its header is invalid");
  }
  if (length != frame.body.size()) return invalid_message("its length differs from its header");
  return frame;
}

void write_frame(LiveType type, const LiveHeader& header, std::vector<std::uint8_t>& bytes,
                 const std::function<void(ByteWriter&)>& write_body) {
  bytes.clear();
  ByteWriter writer(bytes);
  for (const std::uint8_t letter : kMagic) writer.integer(letter);
  writer.integer(static_cast<std::uint8_t>(kLiveProtocolVersion));
  writer.integer(static_cast<std::uint8_t>(type));
  writer.integer(std::uint16_t{0});
  writer.integer(header.sequence);
  writer.integer(std::uint32_t{0});
  writer.f64(header.clock);
  write_body(writer);
  const std::size_t length = bytes.size() - kHeaderBytes;
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
      if (!frame->body.empty()) return invalid_message("a ping has content");
      return PageMessage{frame->header, LivePing{}};
    default:
      return invalid_message("type " + std::to_string(frame->type) +
                             " is not one that a page sends");
  }
}

std::vector<std::uint8_t> encode(const PageMessage& message) {
  constexpr std::array kTypes{LiveType::hello, LiveType::tool, LiveType::command, LiveType::ping};
  std::vector<std::uint8_t> bytes;
  write_frame(kTypes[message.content.index()], message.header, bytes,
              [&](ByteWriter& writer) { std::visit(PageBody{writer}, message.content); });
  return bytes;
}

}  // namespace pcavr
