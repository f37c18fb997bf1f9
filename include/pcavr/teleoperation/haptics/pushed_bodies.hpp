// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"

namespace pcavr {

/// The bodies that a haptic world's tool pushes: by default a PredictedWorld of its own; at an
/// operator's site the predicted world that the robot's site corrects. Base frame, SI. Called by
/// the haptic world's thread alone.
class PushedBodies {
 public:
  virtual ~PushedBodies() = default;

  [[nodiscard]] virtual std::size_t size() const = 0;
  [[nodiscard]] virtual const std::string& name(std::size_t body) const = 0;
  [[nodiscard]] virtual const std::vector<BodyState>& state() const = 0;
  [[nodiscard]] virtual Pose T_base_object(std::size_t body) const = 0;

  /// The displayed pose: a corrected body blends to its pose.
  [[nodiscard]] virtual Pose shown(std::size_t body) const { return T_base_object(body); }

  /// Whether set_state() has an effect: whether bodies can be put back, and fall off their support.
  /// Bodies that exist elsewhere can't.
  [[nodiscard]] virtual bool can_set_state() const { return true; }
  virtual void set_state(const std::vector<BodyState>& state) = 0;

  /// One cycle of `dt` [s] while the tip's centre goes from `p_base_before` to `p_base_tip` [m].
  virtual void step(const Eigen::Vector3d& p_base_before, const Eigen::Vector3d& p_base_tip,
                    double dt) noexcept = 0;
  /// The same while the tool is not engaged; it rests at `p_base_tool` [m].
  virtual void rest(const Eigen::Vector3d& p_base_tool, double dt) noexcept = 0;
};

}  // namespace pcavr
