// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/recordings/rosbag/ros_messages.hpp"

namespace pcavr {

/// The header of a decoded message; those of all transforms; none for a message not decoded.
[[nodiscard]] inline std::vector<const RosHeader*> headers_of(const RosMessage& message) {
  std::vector<const RosHeader*> headers;
  if (const auto* found = std::get_if<RosTransforms>(&message)) {
    for (const RosTransform& transform : found->transforms) headers.push_back(&transform.header);
    return headers;
  }
  std::visit(
      [&](const auto& content) {
        if constexpr (requires { content.header; }) headers.push_back(&content.header);
      },
      message);
  return headers;
}

}  // namespace pcavr
