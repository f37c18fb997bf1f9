// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/simulation/plant.hpp"

#include "simulation/tip_contact.hpp"

namespace pcavr::simulation {

/// Generates the commanded trajectory of a tool from its moves, each planned from the bodies' poses
/// when it begins.
class ToolPlan {
 public:
  ToolPlan(const std::vector<ToolMove>& moves, const Eigen::Vector3d& p_base_start)
      : moves_(moves), p_base_(p_base_start) {}

  [[nodiscard]] bool is_done() const { return current_ == moves_.size(); }
  /// Index of the current move.
  [[nodiscard]] std::size_t current() const { return current_; }
  [[nodiscard]] std::optional<std::size_t> watched_body() const {
    return is_done() ? std::nullopt : moves_[current_].body;
  }

  /// Advances the command by dt [s]. `T_base_body` is the watched body's pose now, `force` [N] that
  /// of the tip.
  void advance(const Pose& T_base_body, double force, double dt);

  /// The tip flies freely now: call follow() after each step.
  [[nodiscard]] bool is_released() const {
    return !is_done() && has_begun_ && moves_[current_].release.has_value();
  }
  /// Sets the command to the flying tip; ends the flight.
  void follow(const Tip& tip, bool is_touched, double dt);

  [[nodiscard]] const Eigen::Vector3d& p_base() const { return p_base_; }
  [[nodiscard]] const Eigen::Vector3d& v_base() const { return v_base_; }

 private:
  void begin(const Pose& T_base_body);
  [[nodiscard]] bool should_stop(const Pose& T_base_body, double force) const;

  const std::vector<ToolMove>& moves_;
  Eigen::Vector3d p_base_;
  Eigen::Vector3d v_base_ = Eigen::Vector3d::Zero();
  std::size_t current_ = 0;
  bool has_begun_ = false;
  bool has_touched_ = false;             ///< in this flight
  std::optional<double> stop_detected_;  ///< `time_` at which the stop condition was met
  Eigen::Vector3d start_;
  Eigen::Vector3d direction_;
  Eigen::Vector3d body_at_start_;
  double length_ = 0.0;    ///< [m]
  double distance_ = 0.0;  ///< along the path, without modulation [m]
  double speed_ = 0.0;     ///< without modulation [m/s]
  double time_ = 0.0;      ///< since the move began [s]
  double dwelled_ = 0.0;   ///< since it ended [s]
};

}  // namespace pcavr::simulation
