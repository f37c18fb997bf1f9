// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/object_pose.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {
namespace {

// Lost without a frame for this many intervals: single frames are missing in any recording.
constexpr double kMaxMissedFrames = 3.5;
// Frames of an object at rest that are averaged: a second of an ordinary camera.
constexpr int kMaxAveragedFrames = 30;
// Share of a frame's std that averaging does not reduce: calibration, and noise that is correlated.
constexpr double kSystematicShare = 0.5;
// Frames over which the motion of a pushed body is measured, the contact's displacement over which
// it can be [m], and stds of a rotation that is one.
constexpr std::size_t kMotionFrames = 5;
constexpr double kMinMotion = 0.001;
constexpr double kTurnStds = 3.0;
// A relative std above this carries no information on the penetration.
constexpr double kMaxPenetrationStd = 0.5;

// Interval of the frames until it is measured [s], and frames over which it is.
constexpr double kTypicalFrameInterval = 1.0 / 30.0;
constexpr std::size_t kMaxGaps = 31;

// Contacts in which parameters are tried.
constexpr std::size_t kMaxSeenContacts = 3;

}  // namespace

ObjectPose::ObjectPose(const TeleopObject& object, const TeleopOptions& options,
                       const SensorProperties& sensors, double tool_radius, double start)
    : monitor_(start, sensors, options.phases, object.is_movable),
      source_(&object),
      options_(options.pose),
      max_contact_time_(options.learning.max_contact_time),
      surface_(object.model),
      tool_radius_(tool_radius),
      latest_{start, object.T_base_object, std::sqrt(3.0) * options.pose.initial_std, 0.0},
      T_base_object_(object.T_base_object),
      before_contact_(latest_),
      slow_slide_(options.phases.slow_slide_window, options.phases.slow_slide_displacement),
      frame_interval_(kTypicalFrameInterval),
      measured_surface_(options.pose.max_surface_offset,
                        object.T_base_object.rotation().inverse() * Eigen::Vector3d::UnitZ()) {}

void ObjectPose::add_tracked(const TrackedPose& pose) { waiting_.push_back(pose); }

void ObjectPose::update_tracking(double t, double camera_offset) {
  for (; !waiting_.empty() && waiting_.front().t - camera_offset <= t; waiting_.pop_front()) {
    TrackedPose seen = noise_.at_least(waiting_.front());
    seen.t -= camera_offset;
    // Slides start and stop between frames.
    if (!slides(monitor_.phase())) noise_.add(seen);
    measure_interval(seen.t);
    update_motion(seen);
    latest_ = averaged_at_rest(seen);
    T_base_object_ = latest_.T_base_object;
    compare_with_before_contact();
    record_contact(seen);
    detect_slow_slide(seen);
    remember(seen);
    seen_.push_back(seen);
    if (seen_.size() > kMotionFrames) seen_.pop_front();
    measure_motion();
    ++frames_;
  }
}

void ObjectPose::update_motion(const TrackedPose& seen) {
  const bool has_seen_before = frames_ > 0;
  const TrackedPose before = seen_.size() > 1 ? seen_[seen_.size() - 2] : latest_;
  const double duration = seen.t - before.t;
  const double displacement =
      (seen.T_base_object.translation() - before.T_base_object.translation()).head<2>().norm();
  const double position_std = std::hypot(seen.position_std, before.position_std) / std::sqrt(3.0);
  is_seen_moving_ =
      has_seen_before && duration > 0.0 &&
      displacement > std::max(options_.moved_stds * position_std, options_.min_displacement) &&
      displacement > options_.min_speed * duration;
  const double rotation =
      std::remainder(heading_of(seen.T_base_object) - heading_of(before.T_base_object), 2.0 * M_PI);
  const double rotation_std = std::hypot(seen.rotation_std, before.rotation_std);
  yaw_rate_ = has_seen_before && std::abs(rotation) > 3.0 * rotation_std && std::abs(rotation) < 1.0
                  ? rotation / duration
                  : 0.0;
  const bool has_moved_away = displacement > options_.moved_stds * position_std &&
                              displacement > 2.0 * options_.min_displacement;
  if (has_moved_away && !monitor_.is_touched()) touched_std_ = 0.0;
}

void ObjectPose::compare_with_before_contact() {
  if (!monitor_.is_touched()) {
    before_contact_ = latest_;
    has_moved_in_contact_ = false;
    return;
  }
  const double displacement =
      (latest_.T_base_object.translation() - before_contact_.T_base_object.translation())
          .head<2>()
          .norm();
  const double std =
      std::hypot(latest_.position_std, before_contact_.position_std) / std::sqrt(3.0);
  has_moved_in_contact_ =
      has_moved_in_contact_ ||
      displacement > std::max(options_.moved_stds * std, options_.min_displacement);
}

void ObjectPose::record_contact(const TrackedPose& seen) {
  if (!monitor_.is_touched()) return;
  const double begin = monitor_.contact_begin();
  if (tracked_contacts_.empty() || tracked_contacts_.back().begin != begin) {
    // A press shows the law of another face than the pushes after it, with another surface.
    if (!tracked_contacts_.empty() && tracked_contacts_.back().kind == ContactKind::press)
      tracked_contacts_.pop_back();
    if (tracked_contacts_.size() == kMaxSeenContacts) tracked_contacts_.pop_front();
    Contact& contact = tracked_contacts_.emplace_back();
    contact.kind = monitor_.is_press() ? ContactKind::press : ContactKind::push;
    contact.begin = begin;
    contact.T_base_object = before_contact_.T_base_object;
  }
  Contact& contact = tracked_contacts_.back();
  contact.direction_base = monitor_.direction_base();
  if (seen.t >= begin && seen.t <= begin + kMaxTrackedTime) contact.tracked.push_back(seen);
}

void ObjectPose::remember(const TrackedPose& seen) {
  if (!history_.empty() && history_.front().t < seen.t - 2.0 * max_contact_time_) {
    std::erase_if(history_,
                  [&](const TrackedPose& pose) { return pose.t < seen.t - max_contact_time_; });
  }
  history_.push_back(seen);
}

std::vector<TrackedPose> ObjectPose::tracked_between(double begin, double end) const {
  const auto by_time = [](const TrackedPose& pose, double t) { return pose.t < t; };
  const auto from = std::lower_bound(history_.begin(), history_.end(), begin, by_time);
  const auto to = std::lower_bound(from, history_.end(), end, by_time);
  return {from, to};
}

void ObjectPose::detect_slow_slide(const TrackedPose& seen) {
  if (!is_pushed()) {
    slow_contact_begin_.reset();
    return;
  }
  const Eigen::Vector3d& direction = monitor_.direction_base();
  if (slow_contact_begin_ != monitor_.contact_begin()) {
    slow_contact_begin_ = monitor_.contact_begin();
    touched_object_ = before_contact_.T_base_object.inverse() * p_base_tip_;
    slow_slide_.restart(p_base_tip_.dot(monitor_.advance_base()));
  }
  if (slides(monitor_.phase()) && !monitor_.is_slow_slide()) {
    slow_slide_.restart();
    return;
  }
  const Eigen::Vector3d p_base_touched = seen.T_base_object * touched_object_;
  const double arm = (p_base_touched - seen.T_base_object.translation()).head<2>().norm();
  slow_slide_.add({seen.t, p_base_touched.dot(direction),
                   std::hypot(seen.position_std / std::sqrt(3.0), seen.rotation_std * arm),
                   p_base_tip_.dot(monitor_.advance_base())});
  if (monitor_.is_slow_slide()) {
    if (!slow_slide_.is_at_rest()) return;
    monitor_.end_slow_slide();
    slow_slide_.restart();
  } else if (const std::optional<double> onset = slow_slide_.onset()) {
    monitor_.begin_slow_slide(*onset);
  }
}

void ObjectPose::measure_interval(double t) {
  if (seen_.empty()) return;
  gaps_.push_back(t - seen_.back().t);
  if (gaps_.size() > kMaxGaps) gaps_.pop_front();
  frame_interval_ = median(std::vector<double>(gaps_.begin(), gaps_.end()));
}

bool ObjectPose::is_apart(const TrackedPose& a, const TrackedPose& b) const {
  const double position_std = std::hypot(a.position_std, b.position_std) / std::sqrt(3.0);
  const double rotation_std = std::hypot(a.rotation_std, b.rotation_std);
  const Pose moved = a.T_base_object.inverse() * b.T_base_object;
  return moved.translation().norm() > options_.moved_stds * position_std ||
         std::abs(heading_of(moved)) > options_.moved_stds * rotation_std;
}

TrackedPose ObjectPose::averaged_at_rest(const TrackedPose& seen) {
  const bool is_apart_from_mean = frames_ > 0 && is_apart(latest_, seen);
  const bool rests = frames_ > 0 && !is_seen_moving_ && monitor_.phase() != MotionPhase::sliding &&
                     !is_apart_from_mean;
  // A single frame far from the others is noise: an object that nothing touches has moved only if
  // the next frame is away, too.
  const bool is_alone = averaged_frames_ > 1 && !monitor_.is_touched() && !was_apart_;
  was_apart_ = !rests;
  if (!rests && is_alone) {
    TrackedPose mean = latest_;
    mean.t = seen.t;
    return mean;
  }
  averaged_frames_ = rests ? std::min(averaged_frames_ + 1, kMaxAveragedFrames) : 1;
  TrackedPose mean = seen;
  if (monitor_.is_slow_slide()) {
    // The stds are those of an average: its frames agree with the tip's motion.
    mean.position_std *= kSystematicShare;
    mean.rotation_std *= kSystematicShare;
  }
  if (averaged_frames_ == 1) return mean;
  mean.T_base_object =
      interpolate(latest_.T_base_object, seen.T_base_object, 1.0 / averaged_frames_);
  const double gain = std::max(1.0 / std::sqrt(averaged_frames_), kSystematicShare);
  mean.position_std *= gain;
  mean.rotation_std *= gain;
  return mean;
}

void ObjectPose::end_average() {
  if (averaged_frames_ <= 1) return;
  // A slide is noticed after it has begun: of the averaged frames only the newest shows where to.
  averaged_frames_ = 1;
  latest_ = seen_.back();
  T_base_object_ = latest_.T_base_object;
}

void ObjectPose::measure_motion() {
  motion_.reset();
  if (!is_pushed() || !slides(monitor_.phase())) return;
  const TrackedPose& now = seen_.back();
  const std::optional<double> end = monitor_.displacement_at(now.t);
  for (const TrackedPose& past : seen_) {
    const std::optional<double> begin = monitor_.displacement_at(past.t);
    if (!begin || !end || *end - *begin < kMinMotion) continue;
    const double rotation =
        std::remainder(heading_of(now.T_base_object) - heading_of(past.T_base_object), 2.0 * M_PI);
    if (std::abs(rotation) < kTurnStds * std::hypot(now.rotation_std, past.rotation_std)) return;
    const Eigen::Vector3d shift =
        now.T_base_object.translation() - past.T_base_object.translation();
    motion_ = PushedMotion{shift.head<2>() / (*end - *begin), rotation / (*end - *begin)};
    return;
  }
}

Pose ObjectPose::moved_on(const Pose& T_base_object, double displacement) const {
  if (!motion_) {
    return Pose::from_translation(displacement * monitor_.direction_base()) * T_base_object;
  }
  PlanarPose pose = planar_pose_of(T_base_object);
  pose.x += displacement * motion_->shift_base.x();
  pose.y += displacement * motion_->shift_base.y();
  pose.yaw += displacement * motion_->rotation;
  return pose_at(pose, T_base_object);
}

bool ObjectPose::is_lost(double t) const {
  return t - latest_.t > kMaxMissedFrames * frame_interval_;
}

double ObjectPose::displacement_since_frame(double t) const {
  const std::optional<double> now = monitor_.displacement_at(t);
  if (!now) return 0.0;
  return *now - monitor_.displacement_at(latest_.t).value_or(0.0);
}

Touch ObjectPose::touch(const Eigen::Vector3d& p_base_tip) const {
  return surface_.touch(T_base_object_, p_base_tip, tool_radius_);
}

PoseEstimate ObjectPose::estimate(const TouchSample& sample, const PlanarPose& predicted,
                                  const ObjectParameters& known) {
  p_base_tip_ = sample.p_base_tip;
  if (!is_lost(sample.t)) return estimate_from_frame(sample, known);
  PoseEstimate estimate = estimate_from_prediction(sample, predicted, known);
  T_base_object_ = estimate.T_base_object;
  return estimate;
}

PoseEstimate ObjectPose::estimate_from_frame(const TouchSample& sample,
                                             const ObjectParameters& known) {
  const bool is_moving = monitor_.phase() == MotionPhase::sliding;
  if (is_moving) end_average();
  PoseEstimate estimate{latest_.T_base_object, latest_.position_std / std::sqrt(3.0), true};
  const double displacement = displacement_since_frame(sample.t);
  if (is_pushed() && (is_moving || std::abs(displacement) > options_.min_displacement)) {
    estimate.T_base_object = moved_on(estimate.T_base_object, displacement);
  }
  estimate.is_current = !is_moving || is_pushed();
  measure_surface(sample, estimate, known);

  if (const std::optional<ContactOffset> face = offset_by_contact(sample, estimate, known)) {
    const double gain = touched_std_ > 0.0 ? options_.offset_gain : 1.0;
    touched_offset_ += gain * (face->offset_base - touched_offset_);
    touched_std_ = face->std;
    apply(*face, estimate);
  } else if (touched_std_ > 0.0) {
    apply({touched_offset_, std::min(estimate.std, touched_std_)}, estimate);
  }
  return estimate;
}

PoseEstimate ObjectPose::estimate_from_prediction(const TouchSample& sample,
                                                  const PlanarPose& predicted,
                                                  const ObjectParameters& known) const {
  const double drift = options_.untracked_drift * std::abs(displacement_since_frame(sample.t));
  PoseEstimate estimate{pose_at(predicted, latest_.T_base_object),
                        latest_.position_std / std::sqrt(3.0) + drift, false};
  if (const std::optional<ContactOffset> face = offset_by_contact(sample, estimate, known)) {
    apply(*face, estimate);
    estimate.is_current = true;
  }
  return estimate;
}

std::optional<ObjectPose::ContactOffset> ObjectPose::offset_by_contact(
    const TouchSample& sample, const PoseEstimate& estimate, const ObjectParameters& known) const {
  const double force = monitor_.resting_force();
  if (!is_pushed() || !known.contact_stiffness || force <= options_.min_force) return std::nullopt;
  const double stiffness = known.contact_stiffness->value;
  const double exponent = known.contact_exponent ? known.contact_exponent->value : 1.0;
  const double relative_std =
      penetration_std(known, force).value_or(options_.default_penetration_std);
  const double penetration =
      static_penetration({.stiffness = stiffness, .exponent = exponent}, force);
  const double touch_std =
      std::hypot(filtered_tip_noise(), std::min(relative_std, kMaxPenetrationStd) * penetration);
  const Touch tip = surface_.touch(estimate.T_base_object, sample.p_base_tip, tool_radius_);
  if (!std::isfinite(tip.gap) || !is_pressed(tip)) return std::nullopt;
  const std::optional<Eigen::Vector3d> offset =
      surface_offset({.stiffness = stiffness, .exponent = exponent}, known);
  const double error = (offset ? tip.normal_object.dot(*offset) : 0.0) - tip.gap - penetration;
  const double variance = estimate.std * estimate.std;
  const double weight = variance / (variance + touch_std * touch_std);
  return ContactOffset{weight * error * monitor_.direction_base(),
                       estimate.std * std::sqrt(1.0 - weight)};
}

double ObjectPose::filtered_tip_noise() const {
  const double gain = options_.offset_gain;
  return monitor_.sensors().tip_noise * std::sqrt(gain / (2.0 - gain));
}

bool ObjectPose::is_pressed(const Touch& tip) const {
  // The force along the push is that of a wall while the tip is on the floor of a hole.
  constexpr double kMinCosine = 0.5;  // 60 degrees: a push may go round a curved face
  return tip.inward_base.dot(monitor_.direction_base()) > kMinCosine;
}

void ObjectPose::measure_surface(const TouchSample& sample, const PoseEstimate& estimate,
                                 const ObjectParameters& known) {
  const double force = monitor_.resting_force();
  if (force <= options_.min_force || measured_frame_ == frames_) return;
  // A press shows the height, unless it has been identified, from more samples.
  const bool is_press = monitor_.is_touched() && monitor_.is_press();
  if (is_press && known.contact_surface_offset) return;
  if (!is_press && !is_pushed()) return;
  measured_frame_ = frames_;
  // Height and tilt at the operator's site remain those of the scene.
  const Pose T_base_shown =
      is_press ? pose_at(planar_pose_of(estimate.T_base_object), source_->T_base_object)
               : estimate.T_base_object;
  const Touch tip = surface_.touch(T_base_shown, sample.p_base_tip, tool_radius_);
  if (!std::isfinite(tip.gap) || !is_pressed(tip)) return;
  const double std = std::hypot(estimate.std, options_.contact_std,
                                options_.clock_std * std::max(monitor_.tip_speed(), 0.0));
  measured_surface_.add(tip.normal_object, tip.gap, std, force);
}

std::optional<Eigen::Vector3d> ObjectPose::surface_offset(const HuntCrossley& law,
                                                          const ObjectParameters& known) const {
  const std::optional<Eigen::Vector3d>& identified = known.contact_surface_offset;
  const std::optional<Eigen::Vector3d> measured = measured_surface_.value(law, identified);
  return measured ? measured : identified;
}

void ObjectPose::apply(const ContactOffset& face, PoseEstimate& estimate) {
  estimate.T_base_object = Pose::from_translation(face.offset_base) * estimate.T_base_object;
  estimate.std = face.std;
}

Eigen::Vector3d ObjectPose::twist() const {
  if (monitor_.phase() != MotionPhase::sliding) return Eigen::Vector3d::Zero();
  // A body that is pushed goes no faster than the tip; where the force falls, the compression's
  // estimate does.
  const double speed = std::min(monitor_.speed(), std::max(monitor_.tip_speed(), 0.0));
  if (!motion_) {
    const Eigen::Vector3d velocity = speed * monitor_.direction_base();
    return {velocity.x(), velocity.y(), yaw_rate_};
  }
  const double rate = speed * motion_->rotation;
  const Eigen::Vector3d arm =
      T_base_object_ * source_->model.centre_of_mass_object - T_base_object_.translation();
  const Eigen::Vector2d velocity =
      speed * motion_->shift_base + rate * Eigen::Vector2d(-arm.y(), arm.x());
  return {velocity.x(), velocity.y(), rate};
}

}  // namespace pcavr
