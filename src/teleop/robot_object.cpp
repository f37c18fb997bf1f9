// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/robot_object.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/contact/compliance.hpp"
#include "pcavr/core/median.hpp"

#include "teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

// Std of an initial pose without tracking [m].
constexpr double kUnseenStd = 0.005;
// Motion between two frames that is significant: standard deviations, displacement [m], speed
// [m/s].
constexpr double kMovedSigmas = 4.0;
constexpr double kMinDisplacement = 5e-4;
constexpr double kMinSpeed = 0.005;
// Std by the tip's calibration, its smoothing and the face's curvature [m].
constexpr double kTouchStd = 1e-4;
// Relative std of the contact law's penetration, if none is stated.
constexpr double kDefaultPenetrationStd = 0.1;
// Less force gives no precise penetration [N].
constexpr double kMinForce = 1.0;
// Gain of the low-pass filter of the offset between camera and contact.
constexpr double kOffsetGain = 0.05;

double median_interval(const std::vector<TrackedPose>& tracked) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < tracked.size(); ++i) gaps.push_back(tracked[i].t - tracked[i - 1].t);
  return gaps.empty() ? 1.0 / 30.0 : median(std::move(gaps));
}

}  // namespace

RobotObject::RobotObject(const TeleopObject& object, const BodyPhysics& assumed,
                         const MonitorOptions& monitor_options,
                         const SwitchOptions& correction_options,
                         std::optional<double> force_ceiling, double tool_radius, double start)
    : monitor(start, monitor_options),
      learner(object.parameters, force_ceiling),
      correction_switch(correction_options),
      acknowledged(sent_parameters(assumed)),
      source_(&object),
      surface_(object.model),
      limit_surface_(assumed.limit_surface),
      tool_radius_(tool_radius),
      latest_{start, object.T_base_object, std::sqrt(3.0) * kUnseenStd, 0.0},
      frame_interval_(median_interval(object.tracked)) {}

void RobotObject::update_tracking(double t) {
  for (; frames_ < source_->tracked.size() && source_->tracked[frames_].t <= t; ++frames_) {
    const TrackedPose& seen = source_->tracked[frames_];
    const bool has_seen_before = frames_ > 0;
    const TrackedPose before = frames_ > 1 ? source_->tracked[frames_ - 2] : latest_;
    const double duration = seen.t - before.t;
    const double displacement =
        (seen.T_base_object.translation() - before.T_base_object.translation()).head<2>().norm();
    const double position_std = std::hypot(seen.position_std, before.position_std) / std::sqrt(3.0);
    is_seen_moving_ = has_seen_before && duration > 0.0 &&
                      displacement > std::max(kMovedSigmas * position_std, kMinDisplacement) &&
                      displacement > kMinSpeed * duration;
    const double rotation = std::remainder(
        heading_of(seen.T_base_object) - heading_of(before.T_base_object), 2.0 * M_PI);
    const double rotation_std = std::hypot(seen.rotation_std, before.rotation_std);
    yaw_rate_ =
        has_seen_before && std::abs(rotation) > 3.0 * rotation_std && std::abs(rotation) < 1.0
            ? rotation / duration
            : 0.0;
    const bool has_moved_away =
        displacement > kMovedSigmas * position_std && displacement > 2.0 * kMinDisplacement;
    if (has_moved_away && !monitor.is_touched()) touched_std_ = 0.0;
    latest_ = seen;
  }
}

bool RobotObject::is_lost(double t) const {
  return frames_ > 0 && t - latest_.t > 3.5 * frame_interval_;
}

double RobotObject::displacement_since_frame(double t) const {
  const std::optional<double> now = monitor.displacement_at(t);
  if (!now) return 0.0;
  return *now - monitor.displacement_at(latest_.t).value_or(0.0);
}

Reach RobotObject::reach(const Eigen::Vector3d& p_base_tip) const {
  return surface_.reach(latest_.T_base_object, p_base_tip, tool_radius_);
}

PoseEstimate RobotObject::estimate_pose(const TouchSample& sample) {
  PoseEstimate estimate{latest_.T_base_object, latest_.position_std / std::sqrt(3.0), true};
  const bool is_moving = monitor.phase() == MotionPhase::sliding;
  const double displacement = displacement_since_frame(sample.t);
  const bool is_extrapolated = monitor.is_touched() && !monitor.is_press();
  if (is_extrapolated && (is_moving || std::abs(displacement) > kMinDisplacement)) {
    estimate.T_base_object =
        Pose::from_translation(displacement * monitor.direction_base()) * estimate.T_base_object;
  }
  if (is_lost(sample.t)) estimate.std += kUntrackedDrift * std::abs(displacement);
  estimate.is_current = !is_moving || is_extrapolated;

  const ObjectParameters& law = learner.known();
  const double force = monitor.resting_force();
  if (is_extrapolated && law.contact_stiffness && force > kMinForce) {
    const double stiffness = law.contact_stiffness->value;
    const double exponent = law.contact_exponent ? law.contact_exponent->value : 1.0;
    const double relative_std =
        law.contact_stiffness->std.value_or(kDefaultPenetrationStd * exponent * stiffness) /
        (stiffness * exponent);
    const double penetration =
        static_penetration({.stiffness = stiffness, .exponent = exponent}, force);
    const double touch_std = std::hypot(kTouchStd, std::min(relative_std, 0.5) * penetration);
    const Reach tip = surface_.reach(estimate.T_base_object, sample.p_base_tip, tool_radius_);
    if (tip.clearance < kFarAway) {
      const double error = -tip.clearance - penetration;
      const double camera_variance = estimate.std * estimate.std;
      const double weight = camera_variance / (camera_variance + touch_std * touch_std);
      const Eigen::Vector3d offset = weight * error * monitor.direction_base();
      touched_offset_ =
          touched_std_ > 0.0
              ? Eigen::Vector3d(touched_offset_ + kOffsetGain * (offset - touched_offset_))
              : offset;
      estimate.std *= std::sqrt(1.0 - weight);
      touched_std_ = estimate.std;
      estimate.T_base_object = Pose::from_translation(offset) * estimate.T_base_object;
      return estimate;
    }
  }
  if (touched_std_ > 0.0) {
    estimate.T_base_object = Pose::from_translation(touched_offset_) * estimate.T_base_object;
    estimate.std = std::min(estimate.std, touched_std_);
  }
  return estimate;
}

Eigen::Vector3d RobotObject::twist() const {
  if (monitor.phase() != MotionPhase::sliding) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d velocity = monitor.speed() * monitor.direction_base();
  return {velocity.x(), velocity.y(), yaw_rate_};
}

BodyPhysics RobotObject::physics() const {
  ObjectParameters estimate = learner.conservative_estimate();
  if (!estimate.limit_surface) estimate.limit_surface = limit_surface_;
  return complete_physics(estimate, source_->model, source_->T_base_object).physics;
}

}  // namespace pcavr
