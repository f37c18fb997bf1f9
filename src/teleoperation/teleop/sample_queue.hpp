// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/tracked_pose.hpp"

#include "teleoperation/teleop/robot_site.hpp"

namespace pcavr {

/// Samples that a robot's site has received, until the cycle to which they belong: tool and force
/// by their stamps, tracked poses a latency later, as RecordingFeed. So what a site decides does
/// not depend on how late its cycles run. A sample whose stamp is later than its arrival, by a
/// sensor's wrong clock, belongs to its arrival.
class SampleQueue {
 public:
  explicit SampleQueue(double tracking_latency) : tracking_latency_(tracking_latency) {}

  /// Samples that are added from now on have arrived at `t` [s].
  void set_arrival(double t) { arrival_ = t; }
  void add_tool(double t, const Eigen::Vector3d& p_base_tip, const Eigen::Quaterniond& q_base_tool);
  void add_wrench(double t, const Eigen::Vector3d& force_base);
  void add_tracked(std::size_t object, const TrackedPose& pose);

  /// The samples that belong to cycles up to `until` [s]; of those from before `start` [s] the
  /// first of each series. A series keeps its order.
  void notify_change(double until, RobotSite& robot,
                     double start = -std::numeric_limits<double>::infinity());

 private:
  struct Tool {
    double due = 0.0;  ///< [s]
    double t = 0.0;
    Eigen::Vector3d p_base_tip;
    Eigen::Quaterniond q_base_tool;
  };
  struct Wrench {
    double due = 0.0;  ///< [s]
    double t = 0.0;
    Eigen::Vector3d force_base;
  };
  struct Tracked {
    double due = 0.0;  ///< [s]
    std::size_t object = 0;
    TrackedPose pose;
  };
  template <typename Sample, typename Receive>
  static void notify_change(double until, double start, std::deque<Sample>& samples,
                            const Receive& receive);
  /// A stamp that is not a number is due at once: the site notes it.
  [[nodiscard]] double due(double t) const { return t < arrival_ ? t : arrival_; }

  double tracking_latency_;  ///< [s]
  double arrival_ = 0.0;     ///< [s]
  std::deque<Tool> tool_;
  std::deque<Wrench> wrench_;
  std::deque<Tracked> tracked_;
};

}  // namespace pcavr
