// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/robot_site.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pcavr/core/check.hpp"

#include "teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

// A force may act on an object whose tracked surface is within this of the tip's [m]: the
// displacement during the tracking's latency at 0.1 m/s.
constexpr double kReach = 0.010;
// The bias is estimated only while no object is this near [m], with this time constant [s].
constexpr double kFreeClearance = 0.002;
constexpr double kBiasTime = 0.25;
constexpr double kDriftFloor = 0.3;  // [N] of undetected bias drift
constexpr double kEnterSigmas = 5.0;
// Latency of the marker tracking [s].
constexpr double kTrackingLatency = 0.030;
// Update interval without a force [s].
constexpr double kCameraInterval = 0.005;
constexpr double kTouchClearance = 0.0005;  // [m]
// Time without contact before a contact that is recorded with it [s].
constexpr double kBefore = 0.3;
// Only the beginning of a longer contact [s] is used for identification, which bounds computing
// time and memory of the force.
constexpr double kMaxLearnedTime = 60.0;
// A contact is processed once more after it has ended [s].
constexpr double kOldContact = 1.0;
// When to identify after the start of a slide, during it, and after its end [s].
constexpr double kAfterOnset = 0.12;
constexpr double kWhileSliding = 0.3;
constexpr double kAfterStop = 0.08;
constexpr double kLearnAgain = 0.2;
// Static friction beyond this ratio of its limit, for this long, contradicts the limit.
constexpr double kMaxLimitRatio = 1.05;
constexpr double kMinTimeAboveLimit = 0.05;  // [s]
// The pose is sent from this error on [m].
constexpr double kMinPoseError = 1e-4;
// A rotation counts as the displacement of a point at this radius [m].
constexpr double kTurnRadius = 0.07;
// Byte budget of the corrections, relative to streaming (rate limit).
constexpr double kBudget = 0.01;
// Bytes that may be sent beyond the budget: a few corrections at the start (burst).
constexpr double kBurst = 400.0;

double wrapped(double angle) { return std::remainder(angle, 2.0 * M_PI); }

bool slides(MotionPhase phase) { return phase == MotionPhase::sliding; }

std::string at_time(double t) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", t);
  return text;
}

/// Damping over stiffness [s/m]; of a linear law, at a penetration of 1 mm.
double relative_damping(const ObjectParameters& known) {
  if (!known.contact_stiffness || !known.contact_damping) return 0.0;
  const double ratio = known.contact_damping->value / known.contact_stiffness->value;
  const bool is_linear = !known.contact_exponent || known.contact_exponent->value == 1.0;
  return is_linear ? ratio / 1e-3 : ratio;
}

MonitorOptions monitor_options(const TipMotion& tip, const ForceSignal& force) {
  MonitorOptions options;
  options.tip_noise = std::max(tip.noise, 1e-6);
  if (force.empty()) return options;
  options.interval = force.interval();
  options.force_noise = force.noise();
  options.correlated = force.correlated();
  options.enter_force = std::max(kEnterSigmas * force.smooth_noise(), kDriftFloor);
  return options;
}

SwitchOptions switch_options(const TeleopOptions& options, const MonitorOptions& monitor) {
  SwitchOptions result;
  result.force_tolerance = options.force_tolerance;
  result.force_floor = monitor.enter_force;
  result.position_tolerance = options.position_tolerance;
  result.round_trip = options.forward_delay + options.backward_delay;
  return result;
}

}  // namespace

std::size_t PredictionLog::cycle_at(double t) const {
  const std::size_t cycles = discarded_ + rows_.size() / objects_;
  const double cycle =
      std::clamp(std::round((t - start_) / step_) - 1.0, 0.0, static_cast<double>(cycles - 1));
  return static_cast<std::size_t>(cycle);
}

const Prediction& PredictionLog::at(double t, std::size_t object) const {
  const std::size_t cycle = cycle_at(t);
  PCAVR_REQUIRE(cycle >= discarded_, t, cycle, discarded_);
  return rows_[(cycle - discarded_) * objects_ + object];
}

void PredictionLog::discard_before(double t) {
  // Rarely, in large blocks: the remaining rows must be moved.
  constexpr std::size_t kMinBlock = 4096;  // cycles: some seconds
  if (rows_.empty() || cycle_at(t) < discarded_ + kMinBlock) return;
  const std::size_t old = cycle_at(t) - discarded_;
  rows_.erase(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(old * objects_));
  discarded_ += old;
}

RobotSite::RobotSite(const TeleopInput& input, const TeleopOptions& options, const TipMotion& tip,
                     ForceSignal& force, const InputFindings& findings,
                     const std::vector<BodyPhysics>& physics, double start)
    : input_(input),
      options_(options),
      tip_(tip),
      force_(force),
      has_force_(findings.is_force_usable && !force.empty()),
      monitor_(monitor_options(tip, force)),
      next_camera_update_(start),
      start_(start),
      streamed_frames_(input.objects.size(), 0) {
  const SwitchOptions correction_options = switch_options(options, monitor_);
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    objects_.emplace_back(input.objects[i], physics[i], monitor_, correction_options,
                          findings.force_ceiling, input.tool_radius, start);
  }
}

void RobotSite::note_once(const std::string& text) {
  if (std::find(notes_.begin(), notes_.end(), text) == notes_.end()) notes_.push_back(text);
}

std::vector<CorrectionMessage> RobotSite::advance(double now, const PredictionLog& log) {
  outgoing_.clear();
  now_ = now;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const std::vector<TrackedPose>& tracked = input_.objects[i].tracked;
    std::size_t& streamed = streamed_frames_[i];
    for (; streamed < tracked.size() && tracked[streamed].t <= now; ++streamed) {
      streaming_bytes_ += bytes_of_tracked_pose();
    }
    acknowledge(objects_[i], log.at(now, i));
  }
  for (; next_sample_ < force_.size() && force_.t(next_sample_) + force_.lag() <= now;
       ++next_sample_) {
    if (force_.t(next_sample_) < start_) continue;
    streaming_bytes_ += bytes_of_wrench_sample();
    if (!has_force_) continue;
    // No frame newer than the force: the displacement since then would count twice.
    update_tracking(std::min(now - kTrackingLatency, force_.t(next_sample_)));
    process_sample(next_sample_, log);
  }
  force_.discard_before(now - force_.lag() - kMaxLearnedTime - kBefore - kOldContact);
  if (!has_force_ && now >= next_camera_update_) {
    next_camera_update_ += kCameraInterval;
    update_tracking(now - kTrackingLatency);
    update_from_camera(now - kTrackingLatency);
    process_time({now - kTrackingLatency, tip_.at(now - kTrackingLatency), Eigen::Vector3d::Zero()},
                 log);
  }
  return std::move(outgoing_);
}

double RobotSite::oldest_needed() const {
  // The next sample is later than now_ - lag; without a force, data is kTrackingLatency old.
  return now_ - force_.lag() - kTrackingLatency - kCameraInterval;
}

void RobotSite::update_tracking(double t) {
  for (RobotObject& object : objects_) object.update_tracking(t);
}

void RobotSite::acknowledge(RobotObject& object, const Prediction& prediction) {
  if (!object.in_flight || prediction.received != object.in_flight->sequence) return;
  overwrite(object.acknowledged, object.in_flight->parameters);
  object.in_flight.reset();
}

void RobotSite::update_from_camera(double t) {
  for (RobotObject& object : objects_) {
    const bool is_near = object.reach(tip_.at(t)).clearance < kTouchClearance;
    object.monitor.update_from_camera(t, object.is_seen_moving(), is_near);
  }
}

std::optional<std::size_t> RobotSite::attribute(const TouchSample& sample,
                                                std::vector<Reach>& reaches) {
  std::optional<std::size_t> nearest, touched;
  std::size_t touching = 0;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    reaches.push_back(objects_[i].reach(sample.p_base_tip));
    if (reaches[i].clearance < kTouchClearance) ++touching;
    if (!nearest || reaches[i].clearance < reaches[*nearest].clearance) nearest = i;
    if (!touched && objects_[i].monitor.is_touched()) touched = i;
  }
  // A contact stays with its object until it ends.
  if (touched) nearest = touched;
  if (!nearest || (!touched && reaches[*nearest].clearance > kReach)) return std::nullopt;
  const bool has_force = sample.force_base.norm() > monitor_.enter_force;
  if (touching > 1 && has_force && !objects_[*nearest].is_shared) {
    note_once("the tip touches " + std::to_string(touching) + " objects at " + at_time(sample.t) +
              ": their shared force is not used to identify");
    objects_[*nearest].is_shared = true;
  }
  return nearest;
}

void RobotSite::estimate_bias(const TouchSample& sample, const std::vector<Reach>& reaches) {
  const bool is_small = sample.force_base.norm() < monitor_.enter_force;
  bool is_clear = true;
  for (const Reach& reach : reaches) is_clear = is_clear && reach.clearance > kFreeClearance;
  if (is_clear && is_small) {
    // Mean of the samples so far, then an exponential moving average over kBiasTime.
    bias_since_ += monitor_.interval;
    const double gain = monitor_.interval / std::min(std::max(bias_since_, 0.02), kBiasTime);
    bias_base_ += gain * sample.force_base;
  }
  bool is_far = !is_small;
  for (const Reach& reach : reaches) is_far = is_far && reach.clearance > kReach;
  far_samples_ = is_far ? far_samples_ + 1 : 0;
  if (static_cast<double>(far_samples_) * monitor_.interval > kMinTimeAboveLimit) {
    note_once("a force far from every object (first at " + at_time(sample.t) +
              "): it is assigned to none of them");
    far_samples_ = 0;
  }
}

void RobotSite::process_sample(std::size_t index, const PredictionLog& log) {
  const ForceSignal::Sample measured = force_.at(index);
  TouchSample sample{measured.t, measured.p_base_tip, measured.smooth_base - bias_base_};
  std::vector<Reach> reaches;
  const std::optional<std::size_t> touched = attribute(sample, reaches);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    RobotObject& object = objects_[i];
    const MotionPhase before = object.monitor.phase();
    const bool was_touched = object.monitor.is_touched();
    object.monitor.step(
        {sample.t, sample.p_base_tip, sample.force_base, reaches[i].direction_base, touched == i},
        object.learner.known().limiting_static_friction, relative_damping(object.learner.known()));
    if (touched != i) object.monitor.update_from_camera(sample.t, object.is_seen_moving(), false);
    plan_learning(object, before, was_touched, sample.t);
  }
  if (!touched || !objects_[*touched].monitor.is_touched()) estimate_bias(sample, reaches);
  if (touched) check_static_limit(objects_[*touched], sample);
  record_force(sample, measured.clean_base, log);
  process_time(sample, log);
}

void RobotSite::process_time(const TouchSample& sample, const PredictionLog& log) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (objects_[i].learn_at <= sample.t) learn(objects_[i], sample.t);
    compare(i, sample, log.at(sample.t, i));
  }
}

void RobotSite::check_static_limit(RobotObject& object, const TouchSample& sample) {
  if (!options_.identifies || object.is_shared) return;
  const bool rests =
      object.monitor.is_touched() && !object.monitor.is_press() && !slides(object.monitor.phase());
  const auto& known = object.acknowledged.limiting_static_friction;
  const double limit =
      std::max(kMaxLimitRatio * known->value, known->value + 3.0 * known->std.value_or(0.0));
  const double friction = sample.force_base.head<2>().norm();
  const bool is_beyond = rests && friction > limit + monitor_.enter_force;
  if (!is_beyond) {
    object.above_limit_since = 1e300;
    return;
  }
  object.above_limit_since = std::min(object.above_limit_since, sample.t);
  if (sample.t - object.above_limit_since < kMinTimeAboveLimit) return;
  const auto& supposed = object.learner.conservative_estimate().limiting_static_friction;
  if (!supposed || friction > supposed->value) object.learner.raise_static_limit(friction);
}

void RobotSite::plan_learning(RobotObject& object, MotionPhase before, bool was_touched, double t) {
  const MotionPhase now = object.monitor.phase();
  if (!was_touched && object.monitor.is_touched()) object.is_shared = false;
  if (!slides(before) && slides(now)) object.learn_at = t + kAfterOnset;
  if (slides(before) && !slides(now)) object.learn_at = t + kAfterStop;
  if (was_touched && !object.monitor.is_touched()) object.learn_at = t + kAfterStop;
  if (!slides(now) || !object.monitor.is_touched()) return;
  for (const RobotObject& other : objects_) {
    if (&other == &object || !other.is_seen_moving()) continue;
    object.is_shared = true;
    note_once(object.source().name + " and " + other.source().name +
              " moved together: their shared force is not used to identify");
  }
}

void RobotSite::learn(RobotObject& object, double t) {
  const bool is_sliding = object.monitor.is_touched() && slides(object.monitor.phase());
  object.learn_at = is_sliding ? t + kWhileSliding : 1e300;
  object.last_learned = t;
  if (!options_.identifies || object.is_shared || !has_force_) return;
  const double begin = object.monitor.contact_begin();
  if (t - begin > kMaxLearnedTime) return;
  const ForceSignal::Record force = force_.between(begin - kBefore, t);
  const auto from = std::lower_bound(tip_.t.begin(), tip_.t.end(), begin - kBefore);
  const auto to = std::upper_bound(from, tip_.t.end(), t);
  const auto first = static_cast<std::size_t>(from - tip_.t.begin());
  const auto count = static_cast<std::size_t>(to - from);
  object.learner.learn(
      {force.t, force.clean_base, tip_.t.subspan(first, count), tip_.p_base.subspan(first, count)},
      begin, object.monitor.has_slid());
}

void RobotSite::record_force(const TouchSample& sample, const Eigen::Vector3d& clean_base,
                             const PredictionLog& log) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const bool is_touched = objects_[i].monitor.is_touched();
    const Eigen::Vector3d& rendered = log.at(sample.t, i).rendered_force_base;
    const double size = rendered.norm();
    if (!is_touched && size <= 0.0) continue;
    const Eigen::Vector3d direction =
        is_touched ? objects_[i].monitor.direction_base() : Eigen::Vector3d(rendered / size);
    const Eigen::Vector3d measured = clean_base - bias_base_;
    const bool is_near = objects_[i].reach(sample.p_base_tip).clearance < kReach;
    forces_.push_back({sample.t, i, is_touched || is_near ? measured.dot(direction) : 0.0,
                       rendered.dot(direction)});
  }
}

void RobotSite::compare(std::size_t index, const TouchSample& sample,
                        const Prediction& prediction) {
  RobotObject& object = objects_[index];
  const PoseEstimate estimate = object.estimate_pose(sample);
  if (!options_.with_corrections) return;
  const PlanarPose here = planar_pose_of(estimate.T_base_object);
  const double gap = std::hypot(here.x - prediction.pose.x, here.y - prediction.pose.y) +
                     kTurnRadius * std::abs(wrapped(here.yaw - prediction.pose.yaw));
  SiteComparison seen;
  seen.t = sample.t;
  seen.robot_slides = slides(object.monitor.phase());
  seen.operator_slides = slides(prediction.phase);
  seen.robot_touches = object.monitor.is_touched();
  seen.operator_touches = prediction.force_base.norm() > 0.0;
  const Eigen::Vector3d& direction = object.monitor.direction_base();
  seen.robot_force = seen.robot_touches ? sample.force_base.dot(direction) : 0.0;
  seen.operator_force =
      seen.robot_touches ? prediction.force_base.dot(direction) : prediction.force_base.norm();
  if (!has_force_) seen.robot_touches = seen.operator_touches = false;
  if (estimate.is_current) seen.position_gap = gap;
  seen.position_std = estimate.std;
  const double allowed = kBurst + kBudget * static_cast<double>(streaming_bytes_);
  const std::optional<CorrectionCase> which =
      object.correction_switch.evaluate(seen, static_cast<double>(sent_bytes_) / allowed);
  if (!which) return;
  if (sample.t - object.last_learned > kLearnAgain && object.monitor.is_touched()) {
    const double planned = object.learn_at;
    learn(object, sample.t);
    object.learn_at = std::min(object.learn_at, planned);
  }
  std::optional<CorrectionMessage> message =
      compose(index, *which, sample, estimate, gap, seen.operator_slides);
  if (!message) {
    object.correction_switch.note_nothing_to_send(*which, sample.t);
    return;
  }
  object.correction_switch.note_sent(*which, now_);
  outgoing_.push_back(std::move(*message));
}

std::optional<CorrectionMessage> RobotSite::compose(std::size_t index, CorrectionCase which,
                                                    const TouchSample& sample,
                                                    const PoseEstimate& estimate, double gap,
                                                    bool operator_slides) {
  RobotObject& object = objects_[index];
  const bool is_pose_current = estimate.is_current && (gap > kMinPoseError);
  const ParameterDifference changed =
      difference(sent_parameters(object.physics()), object.acknowledged);
  CorrectionMessage message;
  message.t = sample.t;
  message.object = index;
  message.which = which;
  if (is_pose_current) {
    // Again, since newly identified contact parameters change it.
    message.pose = planar_pose_of(object.estimate_pose(sample).T_base_object);
    if (operator_slides || slides(object.monitor.phase())) message.twist = object.twist();
  }
  if (changed.has_contact) overwrite(message.parameters, changed.contact);
  if (changed.has_friction) overwrite(message.parameters, changed.friction);
  if (which == CorrectionCase::touched_by_robot && message.pose) {
    const double inside = std::max(-object.reach(sample.p_base_tip).clearance, 0.0);
    message.tool_retraction = -inside * object.monitor.direction_base();
  }
  if (!message.pose && is_empty(message.parameters)) return std::nullopt;
  message.sequence = ++object.sequence;
  object.in_flight = RobotObject::InFlight{message.sequence, message.parameters};
  return message;
}

}  // namespace pcavr
