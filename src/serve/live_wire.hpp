// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/base/core/expected.hpp"
#include "pcavr/serve/live_protocol.hpp"

namespace pcavr {

enum class LiveType : std::uint8_t {
  welcome = 1,
  state = 2,
  notice = 3,
  pong = 4,
  hello = 16,
  tool = 17,
  command = 18,
  ping = 19,
};

/// A message with a valid header; `body` refers to the bytes it was read from.
struct LiveFrame {
  LiveHeader header;
  std::uint8_t type = 0;
  std::span<const std::uint8_t> body;
};
[[nodiscard]] Expected<LiveFrame> read_frame(std::span<const std::uint8_t> bytes);

/// The error for a message that can't be decoded.
[[nodiscard]] Error invalid_message(std::string reason);
/// The value of "protocol"; empty if it is not a valid version number.
[[nodiscard]] std::optional<int> protocol_in(const nlohmann::ordered_json& json);

/// Replaces `bytes` by a header and what `write_body` writes after it.
void write_frame(LiveType type, const LiveHeader& header, std::vector<std::uint8_t>& bytes,
                 const std::function<void(ByteWriter&)>& write_body);

[[nodiscard]] inline Eigen::Vector3f read_vector(ByteReader& reader) {
  const float x = reader.f32();
  const float y = reader.f32();
  return {x, y, reader.f32()};
}
/// Stored x y z w.
[[nodiscard]] inline Eigen::Quaternionf read_quaternion(ByteReader& reader) {
  const Eigen::Vector3f vector = read_vector(reader);
  return {reader.f32(), vector.x(), vector.y(), vector.z()};
}
inline void write_vector(const Eigen::Vector3f& vector, ByteWriter& writer) {
  for (const float value : vector) writer.f32(value);
}
inline void write_quaternion(const Eigen::Quaternionf& quaternion, ByteWriter& writer) {
  for (const float value : quaternion.coeffs()) writer.f32(value);
}
inline void write_text(std::string_view text, ByteWriter& writer) {
  for (const char c : text) writer.integer(static_cast<std::uint8_t>(c));
}

}  // namespace pcavr
