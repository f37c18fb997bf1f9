// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/robot_object.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/core/median.hpp"

#include "teleop/told_parameters.hpp"

namespace pcavr {
namespace {

// Of a start pose that nothing has confirmed [m].
constexpr double kUnseenSigma = 0.005;
// Motion between two frames that is told from noise: deviations, way [m] and speed [m/s].
constexpr double kMovedSigmas = 4.0;
constexpr double kMovedWay = 5e-4;
constexpr double kMovedSpeed = 0.005;
// What the tip's calibration, its smoothing and a bent face leave open [m].
constexpr double kTouchSigma = 1e-4;
// Of a contact law's depth, where nobody said how sure it is [share].
constexpr double kDepthShare = 0.1;
// Less force says little of a depth [N].
constexpr double kMinForce = 1.0;
// How fast the offset between camera and touch is followed.
constexpr double kOffsetGain = 0.05;

double median_interval(const std::vector<TrackedPose>& tracked) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < tracked.size(); ++i) gaps.push_back(tracked[i].t - tracked[i - 1].t);
  return gaps.empty() ? 1.0 / 30.0 : median(std::move(gaps));
}

}  // namespace

RobotObject::RobotObject(const TeleopObject& object, const BodyPhysics& assumed,
                         const MonitorOptions& monitor_options, const SwitchOptions& gate_options,
                         std::optional<double> force_ceiling, double tool_radius, double start)
    : monitor(start, monitor_options),
      learner(object.parameters, force_ceiling),
      gate(gate_options),
      told(told_parameters(assumed)),
      source_(&object),
      surface_(object.model),
      limit_surface_(assumed.limit_surface),
      tool_radius_(tool_radius),
      latest_{start, object.T_base_object, std::sqrt(3.0) * kUnseenSigma, 0.0},
      frame_interval_(median_interval(object.tracked)) {}

void RobotObject::look(double t) {
  for (; frames_ < source_->tracked.size() && source_->tracked[frames_].t <= t; ++frames_) {
    const TrackedPose& seen = source_->tracked[frames_];
    const bool has_seen_before = frames_ > 0;
    const TrackedPose before = frames_ > 1 ? source_->tracked[frames_ - 2] : latest_;
    const double passed = seen.t - before.t;
    const double way =
        (seen.T_base_object.translation() - before.T_base_object.translation()).head<2>().norm();
    const double sigma = std::hypot(seen.position_sigma, before.position_sigma) / std::sqrt(3.0);
    is_seen_moving_ = has_seen_before && passed > 0.0 &&
                      way > std::max(kMovedSigmas * sigma, kMovedWay) && way > kMovedSpeed * passed;
    const double turn = std::remainder(
        heading_of(seen.T_base_object) - heading_of(before.T_base_object), 2.0 * M_PI);
    const double turn_sigma = std::hypot(seen.rotation_sigma, before.rotation_sigma);
    turn_rate_ = has_seen_before && std::abs(turn) > 3.0 * turn_sigma && std::abs(turn) < 1.0
                     ? turn / passed
                     : 0.0;
    const bool has_moved_away = way > kMovedSigmas * sigma && way > 2.0 * kMovedWay;
    if (has_moved_away && !monitor.is_touched()) touched_sigma_ = 0.0;
    latest_ = seen;
  }
}

bool RobotObject::is_lost(double t) const {
  return frames_ > 0 && t - latest_.t > 3.5 * frame_interval_;
}

double RobotObject::way_since_frame(double t) const {
  const std::optional<double> now = monitor.way_at(t);
  if (!now) return 0.0;
  return *now - monitor.way_at(latest_.t).value_or(0.0);
}

Reach RobotObject::reach(const Eigen::Vector3d& p_base_tip) const {
  return surface_.reach(latest_.T_base_object, p_base_tip, tool_radius_);
}

KnownPlace RobotObject::place_at(const TouchSample& sample) {
  KnownPlace place{latest_.T_base_object, latest_.position_sigma / std::sqrt(3.0), true};
  const bool is_moving = monitor.phase() == MotionPhase::sliding;
  const double way = way_since_frame(sample.t);
  const bool is_carried = monitor.is_touched() && !monitor.is_press();
  if (is_carried && (is_moving || std::abs(way) > kMovedWay)) {
    place.T_base_object =
        Pose::from_translation(way * monitor.direction_base()) * place.T_base_object;
  }
  if (is_lost(sample.t)) place.sigma += kUnseenShare * std::abs(way);
  place.is_current = !is_moving || is_carried;

  const ObjectParameters& law = learner.known();
  const double force = monitor.resting_force();
  if (is_carried && law.contact_stiffness && force > kMinForce) {
    const double stiffness = law.contact_stiffness->value;
    const double exponent = law.contact_exponent ? law.contact_exponent->value : 1.0;
    const double share =
        law.contact_stiffness->deviation.value_or(kDepthShare * exponent * stiffness) /
        (stiffness * exponent);
    const double depth = std::pow(force / stiffness, 1.0 / exponent);
    const double touch_sigma = std::hypot(kTouchSigma, std::min(share, 0.5) * depth);
    const Reach tip = surface_.reach(place.T_base_object, sample.p_base_tip, tool_radius_);
    if (tip.clearance < kFarAway) {
      const double ahead = -tip.clearance - depth;
      const double camera = place.sigma * place.sigma;
      const double weight = camera / (camera + touch_sigma * touch_sigma);
      const Eigen::Vector3d offset = weight * ahead * monitor.direction_base();
      touched_offset_ =
          touched_sigma_ > 0.0
              ? Eigen::Vector3d(touched_offset_ + kOffsetGain * (offset - touched_offset_))
              : offset;
      place.sigma *= std::sqrt(1.0 - weight);
      touched_sigma_ = place.sigma;
      place.T_base_object = Pose::from_translation(offset) * place.T_base_object;
      return place;
    }
  }
  if (touched_sigma_ > 0.0) {
    place.T_base_object = Pose::from_translation(touched_offset_) * place.T_base_object;
    place.sigma = std::min(place.sigma, touched_sigma_);
  }
  return place;
}

Eigen::Vector3d RobotObject::twist() const {
  if (monitor.phase() != MotionPhase::sliding) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d velocity = monitor.speed() * monitor.direction_base();
  return {velocity.x(), velocity.y(), turn_rate_};
}

BodyPhysics RobotObject::physics() const {
  ObjectParameters supposed = learner.supposed();
  if (!supposed.limit_surface) supposed.limit_surface = limit_surface_;
  return complete_physics(supposed, source_->model, source_->T_base_object).physics;
}

}  // namespace pcavr
