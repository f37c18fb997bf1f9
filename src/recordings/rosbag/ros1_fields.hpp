// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "recordings/rosbag/record_fields.hpp"

namespace pcavr {

/// The header of a record or connection of a ROS 1 bag: fields NAME=VALUE, each after its length.
class Ros1Fields {
 public:
  /// nullopt where the bytes are no such fields. The bytes must outlive the fields.
  [[nodiscard]] static std::optional<Ros1Fields> parse(std::span<const std::uint8_t> bytes) {
    Ros1Fields fields;
    RecordFields rest(bytes);
    while (!rest.is_at_end()) {
      const std::string_view field = rest.text();
      const std::size_t equals = field.find('=');
      if (!rest.is_valid() || equals == field.npos) return std::nullopt;
      fields.fields_.emplace_back(field.substr(0, equals), field.substr(equals + 1));
    }
    return fields;
  }

  [[nodiscard]] std::optional<std::string_view> text(std::string_view name) const {
    for (const auto& [key, value] : fields_) {
      if (key == name) return value;
    }
    return std::nullopt;
  }
  /// nullopt where it is absent or has another size.
  template <typename Integer>
  [[nodiscard]] std::optional<Integer> integer(std::string_view name) const {
    const std::optional<std::string_view> bytes = text(name);
    if (!bytes || bytes->size() != sizeof(Integer)) return std::nullopt;
    Integer value = 0;
    std::memcpy(&value, bytes->data(), sizeof(Integer));
    return value;
  }

 private:
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

}  // namespace pcavr
