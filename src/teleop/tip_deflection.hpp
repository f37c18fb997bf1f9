// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace pcavr {

/// How far the robot's tip stays behind its command under the force that it exerts: a mass on a
/// critically damped spring. Without compliance it follows at once.
class TipDeflection {
 public:
  /// `mass` [kg]: of the arm as it is felt at the tip.
  explicit TipDeflection(double mass) : mass_(mass) {}
  /// [m/N]
  void set_compliance(double compliance) { compliance_ = compliance; }

  /// One cycle of `dt` [s] under `force_base` [N]; implicit, and so stable for any compliance.
  void step(const Eigen::Vector3d& force_base, double dt) {
    if (!(compliance_ > 0.0)) {
      p_base_.setZero();
      v_base_.setZero();
      return;
    }
    const double rate = 1.0 / std::sqrt(compliance_ * mass_);
    v_base_ += dt * (force_base / mass_ - rate * rate * p_base_);
    v_base_ /= 1.0 + 2.0 * rate * dt + rate * rate * dt * dt;
    p_base_ += dt * v_base_;
  }
  /// [m] Command less tip.
  [[nodiscard]] const Eigen::Vector3d& p_base() const { return p_base_; }

 private:
  double mass_;
  double compliance_ = 0.0;
  Eigen::Vector3d p_base_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_base_ = Eigen::Vector3d::Zero();
};

}  // namespace pcavr
