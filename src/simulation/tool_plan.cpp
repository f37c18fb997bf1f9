// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/tool_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pcavr::simulation {
namespace {

/// A released tip that meets nothing is caught after this [s].
constexpr double kMaxFlight = 1.0;

}  // namespace

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
  stop_detected_.reset();
  distance_ = time_ = dwelled_ = 0.0;
}

bool ToolPlan::should_stop(const Pose& T_base_body, double force) const {
  const ToolMove& move = moves_[current_];
  if (move.until_force && force > *move.until_force) return true;
  if (move.until_travelled && distance_ > *move.until_travelled) return true;
  return move.until_moved &&
         (T_base_body.translation() - body_at_start_).norm() > *move.until_moved;
}

void ToolPlan::advance(const Pose& T_base_body, double force, double dt) {
  v_base_.setZero();
  if (is_done()) return;
  if (!has_begun_) begin(T_base_body);
  const ToolMove& move = moves_[current_];
  time_ += dt;
  if (move.release) return;  // see follow()
  if (!stop_detected_ && should_stop(T_base_body, force)) stop_detected_ = time_;
  const bool is_stopping = stop_detected_ && time_ >= *stop_detected_ + move.reaction_time;
  if (is_stopping && move.blends_into_next) {
    ++current_;
    has_begun_ = false;
    return;
  }
  const double remaining = std::max(0.0, length_ - distance_);
  const double braking = std::sqrt(2.0 * move.acceleration * remaining);
  const double target_speed = is_stopping ? 0.0 : std::min(move.speed, braking);
  const double change = move.acceleration * dt;
  speed_ = std::clamp(target_speed, speed_ - change, speed_ + change);
  distance_ = std::min(length_, distance_ + speed_ * dt);
  // The modulation grows and fades with the speed, so that the move begins and ends at rest.
  const double modulation = move.modulation_amplitude * speed_ / move.speed *
                            std::sin(2.0 * std::numbers::pi * move.modulation_frequency * time_);
  const Eigen::Vector3d p_base_next = start_ + (distance_ + modulation) * direction_;
  v_base_ = (p_base_next - p_base_) / dt;
  p_base_ = p_base_next;
  const bool has_ended = is_stopping ? speed_ <= 0.0 : length_ - distance_ < 1e-7;
  if (!has_ended) return;
  dwelled_ += dt;
  if (dwelled_ < move.dwell) return;
  speed_ = 0.0;
  ++current_;
  has_begun_ = false;
}

void ToolPlan::follow(const Tip& tip, bool is_touched, double dt) {
  p_base_ = tip.p_base;
  speed_ = 0.0;
  if (is_touched) {
    has_touched_ = true;
    dwelled_ = 0.0;
    return;
  }
  dwelled_ += dt;
  const double timeout = has_touched_ ? *moves_[current_].release : kMaxFlight;
  if (dwelled_ < timeout) return;
  ++current_;
  has_begun_ = has_touched_ = false;
}

}  // namespace pcavr::simulation
