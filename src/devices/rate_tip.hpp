// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"
#include "pcavr/devices/device.hpp"
#include "pcavr/devices/rate_options.hpp"

#include "devices/tip_bounds.hpp"

namespace pcavr {

/// What a stick says now.
struct RateCommand {
  /// Away from the operator, to the left, up: of full deflection, at most 1 each.
  Eigen::Vector3d deflection = Eigen::Vector3d::Zero();
  bool is_engaged = false;
  bool is_present = false;
};

/// The tip that a RateCommand moves. It starts where the tool is when the clutch closes.
class RateTip {
 public:
  explicit RateTip(const RateOptions& options) : options_(options) {
    PCAVR_REQUIRE(std::isfinite(options.max_speed) && options.max_speed > 0.0);
    PCAVR_REQUIRE(std::isfinite(options.max_lead) && options.max_lead > 0.0);
    PCAVR_REQUIRE(std::isfinite(options.facing));
  }

  DeviceSample step(const RateCommand& command, double dt,
                    const Eigen::Vector3d& p_base_tool) noexcept {
    said_.is_present = command.is_present;
    const bool is_held = command.is_present && command.is_engaged && is_plausible_tip(p_base_tool);
    if (!is_held || !said_.is_engaged) {
      said_.is_engaged = is_held;
      if (is_plausible_tip(p_base_tool)) said_.p_base_tip = p_base_tool;
      return said_;
    }
    const Eigen::Vector3d deflection = command.deflection.cwiseMax(-1.0).cwiseMin(1.0);
    const Eigen::AngleAxisd q_base_operator(options_.facing, Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d aim =
        said_.p_base_tip + q_base_operator * deflection * (options_.max_speed * dt);
    // Never pulled back, or it would move without a hand: only kept from going farther.
    const double lead = (said_.p_base_tip - p_base_tool).norm();
    said_.p_base_tip = within_reach(p_base_tool, aim, std::max(lead, options_.max_lead));
    return said_;
  }

 private:
  RateOptions options_;
  DeviceSample said_;
};

}  // namespace pcavr
