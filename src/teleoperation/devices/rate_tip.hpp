// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/teleoperation/devices/device.hpp"
#include "pcavr/teleoperation/devices/rate_options.hpp"

#include "teleoperation/devices/tip_bounds.hpp"

namespace pcavr {

/// The current state of a stick.
struct RateCommand {
  /// Forward, left, up: relative to full deflection, at most 1 each.
  Eigen::Vector3d deflection = Eigen::Vector3d::Zero();
  bool is_engaged = false;
  bool is_present = false;
};

/// Rate control: a tip that moves at the velocity of a RateCommand. It starts at the tool when the
/// clutch closes.
class RateTip {
 public:
  explicit RateTip(const RateOptions& options) : options_(options) {
    PCAVR_REQUIRE(std::isfinite(options.max_speed) && options.max_speed > 0.0);
    PCAVR_REQUIRE(std::isfinite(options.max_lead) && options.max_lead > 0.0);
    PCAVR_REQUIRE(std::isfinite(options.facing));
  }

  DeviceSample step(const RateCommand& command, double dt,
                    const Eigen::Vector3d& p_base_tool) noexcept {
    sample_.is_present = command.is_present;
    const bool is_engaged =
        command.is_present && command.is_engaged && is_plausible_tip(p_base_tool);
    if (!is_engaged || !sample_.is_engaged) {
      sample_.is_engaged = is_engaged;
      if (is_plausible_tip(p_base_tool)) sample_.p_base_tip = p_base_tool;
      return sample_;
    }
    const Eigen::Vector3d deflection = command.deflection.cwiseMax(-1.0).cwiseMin(1.0);
    const Eigen::AngleAxisd q_base_operator(options_.facing, Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d target =
        sample_.p_base_tip + q_base_operator * deflection * (options_.max_speed * dt);
    // Anti-windup: limits the lead, but never pulls the tip back, which would move it without
    // input.
    const double lead = (sample_.p_base_tip - p_base_tool).norm();
    sample_.p_base_tip = limit_distance(p_base_tool, target, std::max(lead, options_.max_lead));
    return sample_;
  }

 private:
  RateOptions options_;
  DeviceSample sample_;
};

}  // namespace pcavr
