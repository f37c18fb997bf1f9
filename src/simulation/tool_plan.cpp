// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/tool_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pcavr::simulation {

void ToolPlan::begin(const Pose& T_base_body) {
  const ToolMove& move = moves_[current_];
  const Pose frame = move.body ? T_base_body : Pose();
  start_ = p_base_;
  const Eigen::Vector3d target =
      move.is_offset ? start_ + frame.rotation() * move.target : frame * move.target;
  length_ = (target - start_).norm();
  direction_ = length_ > 0.0 ? Eigen::Vector3d((target - start_) / length_)
                             : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  body_at_start_ = T_base_body.translation();
  has_begun_ = true;
  noticed_.reset();
  way_ = time_ = rested_ = 0.0;
}

bool ToolPlan::shall_stop(const Pose& T_base_body, double force) const {
  const ToolMove& move = moves_[current_];
  if (move.until_force && force > *move.until_force) return true;
  return move.until_moved &&
         (T_base_body.translation() - body_at_start_).norm() > *move.until_moved;
}

void ToolPlan::advance(const Pose& T_base_body, double force, double dt) {
  v_base_.setZero();
  if (is_done()) return;
  if (!has_begun_) begin(T_base_body);
  const ToolMove& move = moves_[current_];
  time_ += dt;
  if (!noticed_ && shall_stop(T_base_body, force)) noticed_ = time_;
  const bool is_stopping = noticed_ && time_ >= *noticed_ + move.reaction;
  if (is_stopping && move.flows_on) {
    ++current_;
    has_begun_ = false;
    return;
  }
  const double left = std::max(0.0, length_ - way_);
  const double braking = std::sqrt(2.0 * move.acceleration * left);
  const double goal = is_stopping ? 0.0 : std::min(move.speed, braking);
  const double change = move.acceleration * dt;
  speed_ = std::clamp(goal, speed_ - change, speed_ + change);
  way_ = std::min(length_, way_ + speed_ * dt);
  // The swing grows and fades with the speed, so that the move begins and ends at rest.
  const double swing = move.swing * speed_ / move.speed *
                       std::sin(2.0 * std::numbers::pi * move.swing_frequency * time_);
  const Eigen::Vector3d next = start_ + (way_ + swing) * direction_;
  v_base_ = (next - p_base_) / dt;
  p_base_ = next;
  const bool has_ended = is_stopping ? speed_ <= 0.0 : length_ - way_ < 1e-7;
  if (!has_ended) return;
  rested_ += dt;
  if (rested_ < move.dwell) return;
  speed_ = 0.0;
  ++current_;
  has_begun_ = false;
}

}  // namespace pcavr::simulation
