// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_message.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/base/core/check.hpp"

#include "link_reader.hpp"

namespace pcavr {
namespace {

constexpr std::array<std::uint8_t, 4> kLinkMagic{'P', 'C', 'V', 'L'};
constexpr std::size_t kLinkHeaderBytes = 32;
constexpr std::size_t kLinkLengthAt = 12;
constexpr std::uint8_t kMotionPhases = 4;
constexpr std::uint32_t kLinkRejections = 5;
constexpr std::uint32_t kLinkStops = 4;
constexpr std::uint32_t kLensModels = 3;
constexpr std::uint32_t kKnownLimits = 31;
constexpr float kMaxCorrectionDelay = 60.0F;  // [s]

void write_link_text(std::string_view text, ByteWriter& writer) {
  PCAVR_REQUIRE(text.size() <= kMaxLinkTextBytes, text.size());
  writer.integer(static_cast<std::uint16_t>(text.size()));
  for (const char c : text) writer.integer(static_cast<std::uint8_t>(c));
}
void write_link_vector(const Eigen::Vector3f& vector, ByteWriter& writer) {
  for (const float value : vector) writer.f32(value);
}
void write_orientation(const Eigen::Quaternionf& q, ByteWriter& writer) {
  for (const float value : q.coeffs()) writer.f32(value);  // x y z w
}
void write_response(const TipResponse& response, ByteWriter& writer) {
  for (const double value : {response.compliance, response.rate, response.damping_ratio,
                             response.lag, response.acceleration_lag}) {
    writer.f32(static_cast<float>(value));
  }
}
TipResponse read_response(LinkReader& reader) {
  TipResponse response;
  for (double* value : {&response.compliance, &response.rate, &response.damping_ratio,
                        &response.lag, &response.acceleration_lag}) {
    *value = static_cast<double>(reader.f32());
  }
  if (!is_plausible(response)) reader.reject("a tool's response out of range");
  return response;
}
void write_count(std::size_t count, ByteWriter& writer) {
  PCAVR_REQUIRE(count <= kMaxLinkObjects, count);
  writer.integer(static_cast<std::uint16_t>(count));
}

// One pair of functions a type, in the order of the variant.

void write_content(const LinkHello& hello, ByteWriter& writer) {
  write_link_text(hello.version, writer);
  write_link_text(hello.name, writer);
}
void read_content(LinkReader& reader, LinkHello& hello) {
  hello.version = reader.text();
  hello.name = reader.text();
}

void write_content(const LinkWelcome& welcome, ByteWriter& writer) {
  writer.f64(welcome.start);
  writer.f64(welcome.tool_radius);
  writer.integer(static_cast<std::uint16_t>(welcome.follows_commands ? 1 : 0));
  write_link_text(welcome.version, writer);
  write_link_text(welcome.scene, writer);
  write_count(welcome.objects.size(), writer);
  for (const std::string& name : welcome.objects) write_link_text(name, writer);
}
void read_content(LinkReader& reader, LinkWelcome& welcome) {
  welcome.start = reader.f64();
  welcome.tool_radius = reader.f64();
  if (!(welcome.tool_radius > 0.0)) reader.reject("a tool's radius that is not above 0");
  welcome.follows_commands = reader.at_most<std::uint16_t>(1, "flags") == 1;
  welcome.version = reader.text();
  welcome.scene = reader.text();
  const std::size_t count = reader.count(2);
  for (std::size_t i = 0; i < count; ++i) welcome.objects.push_back(reader.text());
}

void write_content(const LinkReject& rejected, ByteWriter& writer) {
  writer.integer(static_cast<std::uint32_t>(rejected.reason));
  write_link_text(rejected.text, writer);
}
void read_content(LinkReader& reader, LinkReject& rejected) {
  rejected.reason =
      static_cast<LinkRejection>(reader.at_most<std::uint32_t>(kLinkRejections, "reason", 1));
  rejected.text = reader.text();
}

void write_content(const LinkPing&, ByteWriter&) {}
void read_content(LinkReader&, LinkPing&) {}

void write_content(const LinkPong& pong, ByteWriter& writer) {
  writer.f64(pong.sent);
  writer.f64(pong.received);
}
void read_content(LinkReader& reader, LinkPong& pong) {
  pong.sent = reader.f64();
  pong.received = reader.f64();
}

void write_prediction(const LinkPrediction& prediction, ByteWriter& writer) {
  write_link_vector(prediction.pose, writer);
  write_link_vector(prediction.force, writer);
  write_link_vector(prediction.rendered_force, writer);
  writer.integer(static_cast<std::uint8_t>(prediction.phase));
  writer.integer(prediction.received);
  writer.integer(std::uint16_t{0});
}
constexpr std::size_t kPredictionBytes = 40;
LinkPrediction read_prediction(LinkReader& reader) {
  LinkPrediction prediction;
  prediction.pose = reader.vector();
  prediction.force = reader.vector();
  prediction.rendered_force = reader.vector();
  prediction.phase =
      static_cast<MotionPhase>(reader.at_most<std::uint8_t>(kMotionPhases - 1, "phase"));
  prediction.received = reader.integer<std::uint8_t>();
  reader.zero16();
  return prediction;
}

void write_content(const LinkCommand& command, ByteWriter& writer) {
  writer.f64(command.t);
  write_link_vector(command.p_base_tip, writer);
  write_orientation(command.q_base_tool, writer);
  writer.integer(command.acknowledged.up_to);
  writer.integer(command.acknowledged.later);
  writer.f32(command.correction_delay);
  writer.integer(static_cast<std::uint16_t>(command.is_engaged ? 1 : 0));
  write_count(command.predictions.size(), writer);
  for (const LinkPrediction& prediction : command.predictions) write_prediction(prediction, writer);
}
void read_content(LinkReader& reader, LinkCommand& command) {
  command.t = reader.f64();
  command.p_base_tip = reader.vector();
  command.q_base_tool = reader.orientation();
  command.acknowledged.up_to = reader.integer<std::uint32_t>();
  command.acknowledged.later = reader.integer<std::uint32_t>();
  command.correction_delay = reader.f32();
  if (command.correction_delay < 0.0F || command.correction_delay > kMaxCorrectionDelay) {
    reader.reject("a delay of corrections outside 0 to 60 s");
  }
  command.is_engaged = reader.at_most<std::uint16_t>(1, "flags") == 1;
  const std::size_t count = reader.count(kPredictionBytes);
  for (std::size_t i = 0; i < count; ++i) command.predictions.push_back(read_prediction(reader));
}

void write_tracked(const LinkTrackedObject& object, ByteWriter& writer) {
  write_link_vector(object.position, writer);
  write_orientation(object.orientation, writer);
  writer.f32(object.position_std);
  writer.f32(object.age);
  writer.integer(static_cast<std::uint8_t>(object.phase));
  writer.integer(static_cast<std::uint8_t>(object.is_tracked ? 1 : 0));
  writer.integer(std::uint16_t{0});
}
constexpr std::size_t kTrackedBytes = 40;
LinkTrackedObject read_tracked(LinkReader& reader) {
  LinkTrackedObject object;
  object.position = reader.vector();
  object.orientation = reader.orientation();
  object.position_std = reader.f32();
  object.age = reader.f32();
  object.phase = static_cast<MotionPhase>(reader.at_most<std::uint8_t>(kMotionPhases - 1, "phase"));
  object.is_tracked = reader.at_most<std::uint8_t>(1, "flags") == 1;
  reader.zero16();
  return object;
}

void write_content(const LinkState& state, ByteWriter& writer) {
  const unsigned flags =
      (state.is_engaged ? 1U : 0U) | (state.is_on_hold ? 2U : 0U) | (state.is_stopped ? 4U : 0U);
  writer.f64(state.t);
  writer.f64(state.executed);
  writer.f64(state.received);
  writer.f64(state.applied);
  writer.f32(state.lead);
  writer.integer(state.limits);
  writer.integer(static_cast<std::uint32_t>(flags));
  writer.integer(state.discarded_commands);
  writer.integer(state.corrections);
  write_response(state.tool_response, writer);
  write_link_vector(state.p_base_tip, writer);
  write_orientation(state.q_base_tool, writer);
  write_link_vector(state.force_base, writer);
  write_link_vector(state.torque_base, writer);
  writer.integer(std::uint16_t{0});
  write_count(state.objects.size(), writer);
  for (const LinkTrackedObject& object : state.objects) write_tracked(object, writer);
}
void read_content(LinkReader& reader, LinkState& state) {
  state.t = reader.f64();
  state.executed = reader.f64();
  state.received = reader.f64();
  state.applied = reader.f64();
  state.lead = reader.f32();
  state.limits = reader.at_most<std::uint32_t>(kKnownLimits, "limits");
  const auto flags = reader.at_most<std::uint32_t>(7, "flags");
  state.is_engaged = (flags & 1U) != 0;
  state.is_on_hold = (flags & 2U) != 0;
  state.is_stopped = (flags & 4U) != 0;
  state.discarded_commands = reader.integer<std::uint32_t>();
  state.corrections = reader.integer<std::uint32_t>();
  state.tool_response = read_response(reader);
  state.p_base_tip = reader.vector();
  state.q_base_tool = reader.orientation();
  state.force_base = reader.vector();
  state.torque_base = reader.vector();
  reader.zero16();
  const std::size_t count = reader.count(kTrackedBytes);
  for (std::size_t i = 0; i < count; ++i) state.objects.push_back(read_tracked(reader));
}

void write_content(const LinkCorrection& correction, ByteWriter& writer) {
  PCAVR_REQUIRE(correction.bytes.size() <= kMaxLinkCorrectionBytes, correction.bytes.size());
  writer.integer(correction.number);
  writer.f64(correction.t);
  writer.f64(correction.due);
  writer.integer(static_cast<std::uint16_t>(correction.bytes.size()));
  for (const std::uint8_t byte : correction.bytes) writer.integer(byte);
}
void read_content(LinkReader& reader, LinkCorrection& correction) {
  correction.number = reader.integer<std::uint32_t>();
  if (correction.number == 0) reader.reject("a correction without number");
  correction.t = reader.f64();
  correction.due = reader.f64();
  const auto length = reader.at_most<std::uint16_t>(kMaxLinkCorrectionBytes, "length");
  correction.bytes = reader.bytes(std::min<std::size_t>(length, kMaxLinkCorrectionBytes));
}

void write_content(const LinkAcknowledgement& acknowledged, ByteWriter& writer) {
  writer.integer(acknowledged.up_to);
  writer.integer(acknowledged.later);
}
void read_content(LinkReader& reader, LinkAcknowledgement& acknowledged) {
  acknowledged.up_to = reader.integer<std::uint32_t>();
  acknowledged.later = reader.integer<std::uint32_t>();
}

void write_content(const LinkHeartbeat&, ByteWriter&) {}
void read_content(LinkReader&, LinkHeartbeat&) {}

void write_content(const LinkStop& stop, ByteWriter& writer) {
  writer.integer(static_cast<std::uint32_t>(stop));
}
void read_content(LinkReader& reader, LinkStop& stop) {
  stop = static_cast<LinkStop>(reader.at_most<std::uint32_t>(kLinkStops, "stop", 1));
}

/// Zeros where it is not known.
void write_camera(const std::optional<LinkPictureCamera>& known, ByteWriter& writer) {
  const LinkPictureCamera camera = known.value_or(LinkPictureCamera{});
  for (const float value : {camera.fx, camera.fy, camera.cx, camera.cy}) writer.f32(value);
  writer.integer(static_cast<std::uint32_t>(camera.lens));
  for (const float coefficient : camera.coefficients) writer.f32(coefficient);
}
std::optional<LinkPictureCamera> read_camera(LinkReader& reader) {
  LinkPictureCamera camera;
  for (float* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value = reader.f32();
  camera.lens = static_cast<LensModel>(reader.at_most<std::uint32_t>(kLensModels - 1, "lens"));
  for (float& coefficient : camera.coefficients) coefficient = reader.f32();
  if (camera == LinkPictureCamera{}) return std::nullopt;
  if (!(camera.fx > 0.0F && camera.fy > 0.0F)) reader.reject("a focal length that is not above 0");
  return camera;
}

void write_content(const LinkPicture& picture, ByteWriter& writer) {
  writer.f64(picture.t);
  writer.integer(picture.width);
  writer.integer(picture.height);
  write_camera(picture.camera, writer);
  writer.integer(static_cast<std::uint32_t>(picture.jpeg.size()));
  for (const std::uint8_t byte : picture.jpeg) writer.integer(byte);
}
void read_content(LinkReader& reader, LinkPicture& picture) {
  picture.t = reader.f64();
  picture.width = reader.integer<std::uint16_t>();
  picture.height = reader.integer<std::uint16_t>();
  picture.camera = read_camera(reader);
  picture.jpeg = reader.bytes(reader.integer<std::uint32_t>());
}

void write_content(const LinkPictureReceipt& receipt, ByteWriter& writer) {
  writer.integer(receipt.sequence);
  writer.f64(receipt.received);
}
void read_content(LinkReader& reader, LinkPictureReceipt& receipt) {
  receipt.sequence = reader.integer<std::uint32_t>();
  receipt.received = reader.f64();
}

Error invalid_link_message(const std::string& reason) {
  return {.message = "it has " + reason, .place = "link message"};
}

struct LinkFrame {
  LinkHeader header;
  std::uint8_t type = 0;
  std::span<const std::uint8_t> body;
};

Expected<LinkFrame> read_link_frame(std::span<const std::uint8_t> bytes) {
  const std::optional<int> version = link_version_of(bytes);
  if (!version) return invalid_link_message("no header of pcavr-link");
  if (*version != kLinkVersion) {
    return invalid_link_message("version " + std::to_string(*version) + ", expected " +
                                std::to_string(kLinkVersion));
  }
  ByteReader reader(bytes.subspan(kLinkMagic.size() + 1));
  LinkFrame frame;
  frame.type = reader.integer<std::uint8_t>();
  const auto padding = reader.integer<std::uint16_t>();
  frame.header.sequence = reader.integer<std::uint32_t>();
  const auto length = reader.integer<std::uint32_t>();
  frame.header.session = reader.integer<std::uint32_t>();
  const auto more_padding = reader.integer<std::uint32_t>();
  frame.header.clock = reader.f64();
  frame.body = reader.rest();
  if (!reader.is_valid()) return invalid_link_message("fewer bytes than a header");
  if (padding != 0 || more_padding != 0 || !std::isfinite(frame.header.clock)) {
    return invalid_link_message("an invalid header");
  }
  if (length != frame.body.size()) return invalid_link_message("another length than its header");
  return frame;
}

constexpr std::size_t kLinkTypes = std::variant_size_v<decltype(LinkMessage::content)>;

/// The size limit of a type, by its index in the variant.
std::size_t max_bytes_of(std::size_t index) {
  constexpr std::size_t kPicture = 11;
  static_assert(std::is_same_v<std::variant_alternative_t<kPicture, decltype(LinkMessage::content)>,
                               LinkPicture>);
  return index == kPicture ? kMaxLinkPictureBytes : kMaxLinkMessageBytes;
}

template <std::size_t I = 0>
void emplace_content(std::size_t index, LinkMessage& message) {
  if constexpr (I < kLinkTypes) {
    if (index == I) {
      message.content.emplace<I>();
    } else {
      emplace_content<I + 1>(index, message);
    }
  }
}

}  // namespace

std::optional<int> link_version_of(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kLinkHeaderBytes) return std::nullopt;
  if (!std::equal(kLinkMagic.begin(), kLinkMagic.end(), bytes.begin())) return std::nullopt;
  return bytes[kLinkMagic.size()];
}

Expected<LinkMessage> decode_link_message(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kMaxLinkPictureBytes) return invalid_link_message("more than 1 MiB");
  const Expected<LinkFrame> frame = read_link_frame(bytes);
  if (!frame) return frame.error();
  if (frame->type == 0 || frame->type > kLinkTypes) {
    return invalid_link_message("the unknown type " + std::to_string(frame->type));
  }
  const std::size_t index = frame->type - 1U;
  if (bytes.size() > max_bytes_of(index)) return invalid_link_message("more than 64 KiB");
  LinkMessage message{frame->header, {}};
  emplace_content(index, message);
  LinkReader reader(frame->body);
  std::visit([&reader](auto& content) { read_content(reader, content); }, message.content);
  if (const auto fault = reader.fault()) return invalid_link_message(*fault);
  return message;
}

void encode_link_message(const LinkMessage& message, std::vector<std::uint8_t>& bytes) {
  bytes.clear();
  ByteWriter writer(bytes);
  for (const std::uint8_t letter : kLinkMagic) writer.integer(letter);
  writer.integer(static_cast<std::uint8_t>(kLinkVersion));
  writer.integer(static_cast<std::uint8_t>(message.content.index() + 1));
  writer.integer(std::uint16_t{0});
  writer.integer(message.header.sequence);
  writer.integer(std::uint32_t{0});  // the length, when it is known
  writer.integer(message.header.session);
  writer.integer(std::uint32_t{0});
  writer.f64(message.header.clock);
  std::visit([&writer](const auto& content) { write_content(content, writer); }, message.content);
  PCAVR_REQUIRE(bytes.size() <= max_bytes_of(message.content.index()), bytes.size());
  const std::size_t length = bytes.size() - kLinkHeaderBytes;
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[kLinkLengthAt + i] = static_cast<std::uint8_t>(length >> (8 * i));
  }
}

std::vector<std::uint8_t> encode(const LinkMessage& message) {
  std::vector<std::uint8_t> bytes;
  encode_link_message(message, bytes);
  return bytes;
}

}  // namespace pcavr
