// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "teleoperation/devices/tip_bounds.hpp"

namespace pcavr {

/// Indexing: keeps the offset between hand and tool from closing to opening, and limits the tip's
/// speed, so that the tip never jumps. Positions [m] in base axes.
class Clutch {
 public:
  [[nodiscard]] bool is_closed() const noexcept { return is_closed_; }
  void open() noexcept { is_closed_ = false; }
  void close(const Eigen::Vector3d& p_hand, const Eigen::Vector3d& p_tool) noexcept {
    offset_ = p_tool - p_hand;
    p_tip_ = p_tool;
    is_closed_ = true;
  }
  /// The tip, moved by at most `max_step` [m]; only while closed.
  [[nodiscard]] Eigen::Vector3d follow(const Eigen::Vector3d& p_hand, double max_step) noexcept {
    p_tip_ = limit_distance(p_tip_, p_hand + offset_, max_step);
    return p_tip_;
  }

 private:
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_tip_ = Eigen::Vector3d::Zero();
  bool is_closed_ = false;
};

}  // namespace pcavr
