// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "pcavr/teleoperation/link/tip_response.hpp"

namespace pcavr {

/// Distance by which the robot's tip stays behind its command. Without a known response it follows
/// at once.
class TipDeflection {
 public:
  /// Sets the response from now on; the deflection goes on from where it is.
  void set_response(const TipResponse& response) { response_ = response; }

  /// One cycle of `dt` [s], in which the command goes to `p_base` [m] under `force_base` [N];
  /// implicit, and so stable for any response.
  void step(const Eigen::Vector3d& p_base, const Eigen::Vector3d& force_base, double dt) {
    const Eigen::Vector3d v_base = (p_base - p_base_command_.value_or(p_base)) / dt;
    const Eigen::Vector3d a_base = (v_base - v_base_command_.value_or(v_base)) / dt;
    p_base_command_ = p_base;
    v_base_command_ = v_base;
    if (!(response_.compliance > 0.0)) {
      p_base_.setZero();
      v_base_.setZero();
      return;
    }
    const double rate = response_.rate;
    const Eigen::Vector3d steady = response_.compliance * force_base + response_.lag * v_base +
                                   response_.acceleration_lag * a_base;
    v_base_ += dt * rate * rate * (steady - p_base_);
    v_base_ /= 1.0 + 2.0 * response_.damping_ratio * rate * dt + rate * rate * dt * dt;
    p_base_ += dt * v_base_;
  }
  /// [m] Command less tip.
  [[nodiscard]] const Eigen::Vector3d& p_base() const { return p_base_; }

 private:
  TipResponse response_;
  std::optional<Eigen::Vector3d> p_base_command_ = {};
  std::optional<Eigen::Vector3d> v_base_command_ = {};
  Eigen::Vector3d p_base_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_base_ = Eigen::Vector3d::Zero();
};

}  // namespace pcavr
