// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "plan_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pcavr {
namespace {

constexpr double kInterval = 0.01;           // [s] between two points
constexpr double kPlanTravelSpeed = 0.25;    // [m/s] between contacts
constexpr double kPlanApproachSpeed = 0.05;  // [m/s] next to an object
constexpr double kTravelRate = 0.5;          // [m/s^2] acceleration between contacts
constexpr double kPushRate = 0.3;            // [m/s^2] and in contact: a tenth of friction's
constexpr double kSideGap = 0.015;           // [m] to the surface where the tip comes down
/// [m] to the surface where an approach ends: poses are known to a millimetre or two.
constexpr double kTouchGap = 0.003;
constexpr double kPressDwellTime = 0.1;   // [s]
constexpr double kRestTime = 0.3;         // [s] between contacts: the force's bias is estimated
constexpr double kEnvelopePeriods = 0.5;  // of the modulation, in which it grows and fades

/// Path along a line of this length, from rest to rest.
struct Trapezoid {
  double distance, speed, acceleration;

  Trapezoid(double length, double max_speed, double rate)
      : distance(length),
        speed(std::min(max_speed, std::sqrt(length * rate))),
        acceleration(rate) {}

  [[nodiscard]] double ramp() const { return speed / acceleration; }
  [[nodiscard]] double duration() const { return speed > 0.0 ? distance / speed + ramp() : 0.0; }
  [[nodiscard]] double at(double t) const {
    const double left = duration() - t;
    if (t < ramp()) return 0.5 * acceleration * t * t;
    if (left < ramp()) return distance - 0.5 * acceleration * left * left;
    return speed * (t - 0.5 * ramp());
  }
};

}  // namespace

PlanPath::PlanPath(double tool_radius, double travel_height)
    : tool_radius_(tool_radius), travel_height_(travel_height) {}

Eigen::Vector3d PlanPath::tip_at(const ContactSite& site, double gap) const {
  return site.point_base + (tool_radius_ + gap) * site.outward_base;
}

void PlanPath::move_to(const Eigen::Vector3d& target, double speed, double acceleration) {
  const PlannedPoint from = points_.back();
  const Eigen::Vector3d line = target - from.p_base;
  const Trapezoid profile(line.norm(), speed, acceleration);
  if (!(profile.distance > 0.0)) return;
  for (double t = kInterval; t < profile.duration(); t += kInterval) {
    points_.push_back({from.t + t, from.p_base + profile.at(t) / profile.distance * line});
  }
  points_.push_back({from.t + profile.duration() + kInterval, target});
}

void PlanPath::travel_to(const Eigen::Vector3d& target) {
  const Eigen::Vector3d above(target.x(), target.y(), travel_height_);
  if (points_.empty()) {
    points_.push_back({0.0, above});
    wait(kRestTime);
  }
  move_to(above, kPlanTravelSpeed, kTravelRate);
  move_to(target, kPlanTravelSpeed, kTravelRate);
}

void PlanPath::approach(const ContactSite& site) {
  const Eigen::Vector3d beside = tip_at(site, kSideGap);
  if (points_.empty() || (points_.back().p_base - beside).norm() > kSideGap) travel_to(beside);
  move_to(tip_at(site, kTouchGap), kPlanApproachSpeed, kTravelRate);
  wait(kRestTime);
}

void PlanPath::press(const ContactSite& site, double depth, double speed) {
  move_to(tip_at(site, -depth), speed, kTravelRate);
  wait(kPressDwellTime);
  move_to(tip_at(site, kTouchGap), speed, kTravelRate);
  wait(kRestTime);
}

void PlanPath::load(const ContactSite& site, double advance, double speed) {
  move_to(tip_at(site, -advance), speed, kPushRate);
}

void PlanPath::slide(const ContactSite& site, const SlideMotion& motion) {
  const PlannedPoint from = points_.back();
  const Trapezoid profile(motion.distance, motion.speed, kPushRate);
  const double envelope = kEnvelopePeriods / motion.frequency;
  const double duration = profile.duration();
  for (double t = kInterval; t < duration; t += kInterval) {
    const double share = std::clamp(std::min(t, duration - t) / envelope, 0.0, 1.0);
    const double phase = 2.0 * std::numbers::pi * motion.frequency * t;
    const double advance = profile.at(t) + share * motion.amplitude * std::sin(phase);
    points_.push_back({from.t + t, from.p_base - advance * site.outward_base});
  }
  points_.push_back(
      {from.t + duration + kInterval, from.p_base - motion.distance * site.outward_base});
  wait(kRestTime);
}

void PlanPath::back_off(const ContactSite& site) {
  move_to(points_.back().p_base + kSideGap * site.outward_base, kPlanApproachSpeed, kTravelRate);
  wait(kRestTime);
}

void PlanPath::lift() {
  Eigen::Vector3d above = points_.back().p_base;
  above.z() = travel_height_;
  move_to(above, kPlanTravelSpeed, kTravelRate);
}

void PlanPath::wait(double seconds) {
  PlannedPoint point = points_.back();
  point.t += seconds;
  points_.push_back(point);
}

}  // namespace pcavr
