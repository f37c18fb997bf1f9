// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/motion_plan.hpp"
#include "pcavr/pipeline/plan_motion.hpp"

namespace pcavr {

/// A point on an object's surface that the tip touches, in base.
struct ContactSite {
  Eigen::Vector3d point_base;
  Eigen::Vector3d outward_base;  ///< unit
};

/// Commands of the tip, one motion after the other: straight, with trapezoidal speed.
class PlanPath {
 public:
  /// The tip moves between contacts at this height of its centre [m].
  PlanPath(double tool_radius, double travel_height);

  /// Moves above the site, down beside it, and towards it until just before the surface.
  void approach(const ContactSite& site);
  /// Moves at `speed` [m/s] to `depth` [m] below the surface, and back.
  void press(const ContactSite& site, double depth, double speed);
  /// Moves slowly into the surface and on, by `advance` [m]; the tip stays there.
  void load(const ContactSite& site, double advance, double speed);
  /// Moves on by the slide's distance; the modulation grows and fades within half a period.
  void slide(const ContactSite& site, const SlideMotion& motion);
  void back_off(const ContactSite& site);
  void lift();
  void wait(double seconds);

  [[nodiscard]] std::vector<PlannedPoint> take() { return std::move(points_); }

 private:
  void move_to(const Eigen::Vector3d& target, double speed, double acceleration);
  void travel_to(const Eigen::Vector3d& target);
  [[nodiscard]] Eigen::Vector3d tip_at(const ContactSite& site, double gap) const;

  double tool_radius_;
  double travel_height_;
  std::vector<PlannedPoint> points_;
};

}  // namespace pcavr
