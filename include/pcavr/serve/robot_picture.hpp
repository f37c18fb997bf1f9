// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>

#include "pcavr/serve/content.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr {

/// /api/robot/N.jpg: what the robot's camera saw last, as an operator's site received it, beside
/// the resources of another source. N is its number; an older number is answered by the newest
/// picture. Thread-safe.
class RobotPicture final : public ContentSource {
 public:
  /// Keeps the reference.
  explicit RobotPicture(const ContentSource& others) : others_(others) {}

  void set(const LinkPicture& picture, std::uint32_t number);
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view path) const override;

 private:
  const ContentSource& others_;
  mutable std::mutex mutex_;
  std::shared_ptr<const Content> newest_;
  std::uint32_t number_ = 0;
};

}  // namespace pcavr
