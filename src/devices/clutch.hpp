// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/tip_bounds.hpp"

namespace pcavr {

/// Keeps the difference between a hand and the tool from when it closes to when it opens, and the
/// tip within a speed: the tip never jumps. Positions [m] in base axes.
class Clutch {
 public:
  [[nodiscard]] bool is_closed() const noexcept { return is_closed_; }
  void open() noexcept { is_closed_ = false; }
  void close(const Eigen::Vector3d& p_hand, const Eigen::Vector3d& p_tool) noexcept {
    from_hand_ = p_tool - p_hand;
    p_tip_ = p_tool;
    is_closed_ = true;
  }
  /// The tip, `most` [m] from where it was at most; only while closed.
  [[nodiscard]] Eigen::Vector3d follow(const Eigen::Vector3d& p_hand, double most) noexcept {
    p_tip_ = within_reach(p_tip_, p_hand + from_hand_, most);
    return p_tip_;
  }

 private:
  Eigen::Vector3d from_hand_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_tip_ = Eigen::Vector3d::Zero();
  bool is_closed_ = false;
};

}  // namespace pcavr
