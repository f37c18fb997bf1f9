// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "pcavr/teleoperation/link/motion_limiter.hpp"
#include "pcavr/teleoperation/sites/operator_interface.hpp"

namespace pcavr {

/// An operator who pushes each box of the displayed world to and fro, opens the clutch while the
/// robot holds, and now and then stops the robot. Deterministic.
class SoakPerson final : public OperatorInterface {
 public:
  SoakPerson(const MotionLimits& limits, const Eigen::Vector3d& p_base_start,
             std::vector<Eigen::Vector3d> p_base_objects, double step)
      : limits_(limits),
        step_(step),
        p_base_start_(p_base_start),
        homes_(std::move(p_base_objects)) {}

  /// Stops the robot; it goes on after a while.
  void stop() {
    requests_.is_stopped = true;
    stopped_for_ = 0.0;
  }

  [[nodiscard]] Eigen::Vector3d p_base_start(std::size_t, const LinkState* robot) override {
    return robot != nullptr ? robot->p_base_tip.cast<double>().eval() : p_base_start_;
  }
  void begin(LiveOperatorSite& site) override {
    tip_.reset();
    path_.clear();
    open_for_ = kOpenTime;
    static_cast<void>(site);
  }
  [[nodiscard]] OperatorCommand step(std::size_t, LiveOperatorSite& site,
                                     const OperatorLink& link) override {
    const Eigen::Vector3d p_base_robot = p_base_start(0, link.robot);
    const bool holds = link.robot != nullptr && (link.robot->is_on_hold || link.robot->is_stopped);
    ask(link);
    open_for_ = holds ? kOpenTime : open_for_ - step_;
    const bool is_engaged = open_for_ <= 0.0;
    if (!is_engaged || !tip_) {
      tip_.emplace(limits_, p_base_robot);
      p_base_target_ = tip_->p_base();
      path_.clear();
    }
    if (is_engaged) move(site);
    const Eigen::Vector3d p_base_tip = tip_->step(p_base_target_, Eigen::Vector3d::Zero(), step_);
    site.step(p_base_tip);
    return {p_base_tip, Eigen::Quaterniond::Identity(), is_engaged, std::nullopt};
  }
  [[nodiscard]] OperatorRequests take_requests() override {
    return std::exchange(requests_, OperatorRequests());
  }

 private:
  struct Waypoint {
    Eigen::Vector3d p_base;
    double speed = 0.2;  ///< [m/s]
  };
  static constexpr double kOpenTime = 0.2;       // [s] after a hold and at the beginning
  static constexpr double kStopTime = 1.0;       // [s] until the release
  static constexpr double kAskInterval = 0.3;    // [s]
  static constexpr double kTravelHeight = 0.35;  // [m]
  static constexpr double kStandoff = 0.14;      // [m] from the centre of a box
  static constexpr double kPush = 0.10;          // [m] towards the centre of a box, and a bit on

  /// Releases a stop, and resumes after a hold.
  void ask(const OperatorLink& link) {
    if (link.robot == nullptr || !(link.robot->is_on_hold || link.robot->is_stopped)) return;
    stopped_for_ += step_;
    if (stopped_for_ < kStopTime) return;
    stopped_for_ = kStopTime - kAskInterval;
    if (link.robot->is_stopped) {
      requests_.is_stopped = false;
    } else {
      requests_.is_on_hold = false;
    }
  }

  void move(const LiveOperatorSite& site) {
    if (path_.empty()) plan(site);
    const Waypoint& next = path_.front();
    const Eigen::Vector3d way = next.p_base - p_base_target_;
    const double distance = way.norm();
    const double reach = next.speed * step_;
    if (distance <= reach) {
      p_base_target_ = next.p_base;
      path_.pop_front();
    } else {
      p_base_target_ += (reach / distance) * way;
    }
  }

  void plan(const LiveOperatorSite& site) {
    const std::size_t object = stroke_++ % homes_.size();
    const Eigen::Vector3d centre = site.shown(object).T_base_object.translation();
    // The push is from the side to which the object has been pushed, so that it stays on the table.
    const double side = centre.x() > homes_[object].x() ? 1.0 : -1.0;
    const Eigen::Vector3d beside = centre + Eigen::Vector3d(side * kStandoff, 0.0, 0.0);
    const Eigen::Vector3d pushed = beside - Eigen::Vector3d(side * kPush, 0.0, 0.0);
    const auto above = [](Eigen::Vector3d p) {
      p.z() = kTravelHeight;
      return p;
    };
    path_ = {{above(p_base_target_), 0.3},
             {above(beside), 0.3},
             {beside, 0.2},
             {pushed, 0.05},
             {beside, 0.2}};
  }

  MotionLimits limits_;
  double step_;
  Eigen::Vector3d p_base_start_;
  std::vector<Eigen::Vector3d> homes_;
  std::optional<MotionLimiter> tip_;
  Eigen::Vector3d p_base_target_ = Eigen::Vector3d::Zero();
  std::deque<Waypoint> path_;
  std::size_t stroke_ = 0;
  double open_for_ = kOpenTime;
  double stopped_for_ = 0.0;
  OperatorRequests requests_;
};

}  // namespace pcavr
