// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

namespace pcavr {

/// Moves the tool out of an object that the robot has touched before the operator [paper C, case
/// 1.2b]: an offset from the operator's command to the tool. It grows until the object is not
/// touched, and is used up as the operator moves back along it, without a motion of its own. A tool
/// that is kept off [paper C, case 2] does not follow the operator back into the object, either.
class ToolRetraction {
 public:
  /// `speed` [m/s] of the tool; 0: it stays.
  explicit ToolRetraction(double speed) : speed_(speed) {}

  /// Moves the tool by `displacement` [m] and, along it, until `object` is not touched.
  void begin(std::size_t object, const Eigen::Vector3d& displacement) {
    const double length = displacement.norm();
    if (!(length > 0.0) || !(speed_ > 0.0)) return;
    object_ = object;
    direction_ = displacement / length;
    remaining_ = length;
    moved_ = 0.0;
  }

  /// Does the same as begin(), and the tool stays off until the release.
  void keep_off(std::size_t object, const Eigen::Vector3d& displacement) {
    begin(object, displacement);
    is_kept_off_ = object_ == object;
  }
  void release() { is_kept_off_ = false; }

  /// The object that the tool is being moved out of, or kept off.
  [[nodiscard]] std::optional<std::size_t> object() const { return object_; }

  /// One cycle of `dt` [s] with the operator's command; `is_touched`: object(), by the tool.
  void step(const Eigen::Vector3d& p_base_command, bool is_touched, double dt) {
    if (p_base_command_) follow(p_base_command - *p_base_command_);
    p_base_command_ = p_base_command;
    if (!object_) return;
    if ((remaining_ <= 0.0 && !is_touched) || moved_ >= kMaxLength) {
      if (!is_kept_off_) object_.reset();
      return;
    }
    const double change = speed_ * dt;
    offset_ += change * direction_;
    remaining_ -= change;
    moved_ += change;
  }

  /// [m] Tool less command.
  [[nodiscard]] const Eigen::Vector3d& offset() const { return offset_; }

 private:
  static constexpr double kMaxLength = 0.02;  // [m] of one retraction: a correction is smaller

  /// The part of the operator's motion that the tool does not follow.
  void follow(const Eigen::Vector3d& motion) {
    const double into = is_kept_off_ ? -motion.dot(direction_) : 0.0;
    if (into > 0.0) offset_ += into * direction_;
    const double length = offset_.norm();
    if (!(length > 0.0)) return;
    const double back = motion.dot(offset_) / length;
    if (back > 0.0) offset_ *= std::max(0.0, 1.0 - back / length);
  }

  double speed_;
  std::optional<std::size_t> object_ = {};
  Eigen::Vector3d direction_ = Eigen::Vector3d::Zero();
  double remaining_ = 0.0;  ///< [m] of the displacement
  double moved_ = 0.0;      ///< [m] in this retraction
  bool is_kept_off_ = false;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> p_base_command_ = {};  ///< of the last cycle
};

}  // namespace pcavr
