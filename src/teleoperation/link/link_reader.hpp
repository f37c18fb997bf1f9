// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/base/core/utf8.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr {

/// Reader of what follows the header. Each number that is not finite, each text that is not UTF-8
/// and each enumerator out of range makes the message invalid; the first reason is kept.
class LinkReader {
 public:
  explicit LinkReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::unsigned_integral Integer>
  [[nodiscard]] Integer integer() {
    return bytes_.integer<Integer>();
  }
  /// An enumerator or a set of flags, at most `max`.
  template <std::unsigned_integral Integer>
  [[nodiscard]] Integer at_most(Integer max, const char* what, Integer min = 0) {
    const auto value = bytes_.integer<Integer>();
    if (value < min || value > max) reject(std::string("unknown ") + what);
    return value;
  }
  void zero16() {
    if (bytes_.integer<std::uint16_t>() != 0) reject("padding that is not zero");
  }
  [[nodiscard]] double f64() {
    const double value = bytes_.f64();
    if (!std::isfinite(value)) reject("a number that is not finite");
    return value;
  }
  [[nodiscard]] float f32() {
    const float value = bytes_.f32();
    if (!std::isfinite(value)) reject("a number that is not finite");
    return value;
  }
  [[nodiscard]] Eigen::Vector3f vector() {
    const float x = f32();
    const float y = f32();
    return {x, y, f32()};
  }
  [[nodiscard]] Eigen::Quaternionf orientation() {
    const Eigen::Vector3f vector_part = vector();
    const Eigen::Quaternionf q(f32(), vector_part.x(), vector_part.y(), vector_part.z());
    if (!(std::abs(q.norm() - 1.0F) <= kMaxLinkNormError)) {
      reject("an orientation that is not a unit quaternion");
    }
    return q;
  }
  [[nodiscard]] std::vector<std::uint8_t> bytes(std::size_t count) {
    if (!bytes_.is_valid()) return {};  // a new reader of the rest would forget it
    const std::span<const std::uint8_t> rest = bytes_.rest();
    if (count > rest.size()) {
      reject("a count beyond its end");
      return {};
    }
    const std::span<const std::uint8_t> part = rest.first(count);
    bytes_ = ByteReader(rest.subspan(count));
    return {part.begin(), part.end()};
  }
  [[nodiscard]] std::string text() {
    const auto length = at_most<std::uint16_t>(kMaxLinkTextBytes, "length of a text");
    if (reason_) return {};
    const std::vector<std::uint8_t> content = bytes(length);
    std::string result(content.begin(), content.end());
    if (!is_utf8_text(result)) reject("a text that is not UTF-8");
    return result;
  }
  /// The check keeps a wrong count from making a large vector.
  [[nodiscard]] std::size_t count(std::size_t bytes_each) {
    const auto value = at_most<std::uint16_t>(kMaxLinkObjects, "number of objects");
    if (value * bytes_each > bytes_.rest().size()) reject("a count beyond its end");
    return reason_ ? 0 : value;
  }
  void reject(std::string reason) {
    if (!reason_) reason_ = std::move(reason);
  }
  /// The reason why the content is not valid.
  [[nodiscard]] std::optional<std::string> fault() const {
    if (!bytes_.is_valid()) return "fewer bytes than its type has";
    if (reason_) return reason_;
    if (!bytes_.is_at_end()) return "more bytes than its type has";
    return std::nullopt;
  }

 private:
  // A unit quaternion in single precision has norm 1 to 1e-6; the rest is margin.
  static constexpr float kMaxLinkNormError = 1e-3F;

  ByteReader bytes_;
  std::optional<std::string> reason_;
};

}  // namespace pcavr
