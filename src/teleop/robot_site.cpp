// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/robot_site.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"

#include "teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

// Update interval without a force: shorter than that of any camera [s].
constexpr double kCameraInterval = 0.005;
// A force far from every object is noted after this [s]: not a spike.
constexpr double kMinFarForceTime = 0.05;
// Shortest averaging of the bias at the start [s]: some ten samples of a typical sensor.
constexpr double kMinBiasTime = 0.02;
// Time without contact before a contact that is recorded with it [s].
constexpr double kBefore = 0.3;
// A contact is processed once more after it has ended [s].
constexpr double kOldContact = 1.0;
// Parameters older than this are identified again before a correction is composed [s]: its bytes
// should not carry what is about to change.
constexpr double kLearnAgain = 0.2;

double wrapped(double angle) { return std::remainder(angle, 2.0 * M_PI); }

bool slides(MotionPhase phase) { return phase == MotionPhase::sliding; }

/// Damping over stiffness [s/m]; of a linear law, at a penetration of 1 mm.
double relative_damping(const ObjectParameters& known) {
  if (!known.contact_stiffness || !known.contact_damping) return 0.0;
  const double ratio = known.contact_damping->value / known.contact_stiffness->value;
  const bool is_linear = !known.contact_exponent || known.contact_exponent->value == 1.0;
  return is_linear ? ratio / 1e-3 : ratio;
}

SensorProperties sensor_properties(const TipPath& tip, const ForceSignal& force,
                                   const TouchOptions& options) {
  SensorProperties sensors;
  sensors.tip_noise = std::max(tip.noise, 1e-6);
  if (force.empty()) return sensors;
  sensors.interval = force.interval();
  sensors.force_noise = force.noise();
  sensors.correlated = force.correlated();
  sensors.enter_force = std::max(options.contact_stds * force.smooth_noise(), options.force_drift);
  return sensors;
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

RobotSite::RobotSite(const TeleopInput& input, const TeleopOptions& options, const TipPath& tip,
                     ForceSignal& force, const InputFindings& findings,
                     const std::vector<BodyPhysics>& physics, double start)
    : input_(input),
      options_(options),
      tip_(tip),
      force_(force),
      has_force_(!findings.fault && !force.empty()),
      sensors_(sensor_properties(tip, force, options.touch)),
      next_camera_update_(start),
      start_(start),
      streamed_frames_(input.objects.size(), 0) {
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    objects_.emplace_back(input.objects[i], physics[i], options, sensors_, findings.force_ceiling,
                          input.tool_radius, start);
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
    update_tracking(std::min(now - options_.pose.tracking_latency, force_.t(next_sample_)));
    process_sample(next_sample_, log);
  }
  force_.discard_before(now - force_.lag() - options_.learning.max_contact_time - kBefore -
                        kOldContact);
  if (!has_force_ && now >= next_camera_update_) {
    next_camera_update_ += kCameraInterval;
    const double t = now - options_.pose.tracking_latency;
    update_tracking(t);
    update_from_camera(t);
    process_time({t, tip_.at(t), Eigen::Vector3d::Zero()}, log);
  }
  return std::move(outgoing_);
}

std::vector<CorrectionMessage> RobotSite::full_state(double t) {
  std::vector<CorrectionMessage> messages;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    RobotObject& object = objects_[i];
    if (!object.source().is_movable) continue;
    CorrectionMessage& message = messages.emplace_back();
    message.t = t;
    message.object = i;
    message.pose = planar_pose_of(object.latest_pose());
    message.parameters = sent_parameters(object.physics(), options_.gravity());
    message.sequence = ++object.sequence;
    object.in_flight = RobotObject::InFlight{message.sequence, message.parameters};
  }
  return messages;
}

double RobotSite::oldest_needed() const {
  // The next sample is later than now_ - lag; without a force, data is as old as the tracking.
  return now_ - force_.lag() - options_.pose.tracking_latency - kCameraInterval;
}

void RobotSite::update_tracking(double t) {
  for (RobotObject& object : objects_) object.update_tracking(t);
}

void RobotSite::acknowledge(RobotObject& object, const Prediction& prediction) {
  object.correction_switch.note_received(prediction.received);
  if (!object.in_flight || prediction.received != object.in_flight->sequence) return;
  overwrite(object.acknowledged, object.in_flight->parameters);
  object.in_flight.reset();
}

void RobotSite::update_from_camera(double t) {
  for (RobotObject& object : objects_) {
    const bool is_near = object.touch(tip_.at(t)).gap < options_.touch.touch_clearance;
    object.monitor.update_from_camera(t, object.is_seen_moving(), is_near);
  }
}

std::optional<TouchedBody> RobotSite::attribute(const TouchSample& sample,
                                                std::vector<Touch>& touches) const {
  for (const RobotObject& object : objects_) touches.push_back(object.touch(sample.p_base_tip));
  // A contact stays with its object until it ends.
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (objects_[i].monitor.is_touched()) return TouchedBody{i, false};
  }
  return touched_body(touches, options_.inputs);
}

void RobotSite::estimate_bias(const TouchSample& sample, const std::vector<Touch>& touches) {
  const bool is_small = sample.force_base.norm() < sensors_.enter_force;
  bool is_clear = true;
  for (const Touch& touch : touches) {
    is_clear = is_clear && touch.gap > options_.touch.free_clearance;
  }
  if (is_clear && is_small) {
    // Mean of the samples so far, then an exponential moving average over bias_time.
    bias_since_ += sensors_.interval;
    const double gain =
        sensors_.interval / std::min(std::max(bias_since_, kMinBiasTime), options_.touch.bias_time);
    bias_base_ += gain * sample.force_base;
  }
  bool is_far = !is_small;
  const double reach = options_.inputs.max_touch_gap;
  for (const Touch& touch : touches) is_far = is_far && touch.gap > reach;
  far_samples_ = is_far ? far_samples_ + 1 : 0;
  if (static_cast<double>(far_samples_) * sensors_.interval > kMinFarForceTime) {
    note_once("a force far from every object (first at " + at_time(sample.t) +
              "): it is assigned to none of them");
    far_samples_ = 0;
  }
}

void RobotSite::process_sample(std::size_t index, const PredictionLog& log) {
  const ForceSignal::Sample measured = force_.at(index);
  TouchSample sample{measured.t, measured.p_base_tip, measured.smooth_base - bias_base_};
  std::vector<Touch> touches;
  const std::optional<TouchedBody> attributed = attribute(sample, touches);
  std::optional<std::size_t> touched;
  if (attributed) touched = attributed->body;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    RobotObject& object = objects_[i];
    const MotionPhase before = object.monitor.phase();
    const bool was_touched = object.monitor.is_touched();
    object.monitor.step(
        {sample.t, sample.p_base_tip, sample.force_base, touches[i].inward_base, touched == i},
        object.learner.known().limiting_static_friction, relative_damping(object.learner.known()));
    if (touched != i) object.monitor.update_from_camera(sample.t, object.is_seen_moving(), false);
    plan_learning(object, before, was_touched, sample.t);
    if (!was_touched && object.monitor.is_touched() && attributed && attributed->is_ambiguous) {
      object.is_shared = true;
      note_once("the tip touches " + object.source().name + " and another object at " +
                at_time(sample.t) + ": their shared force is not used to identify");
    }
  }
  if (!touched || !objects_[*touched].monitor.is_touched()) estimate_bias(sample, touches);
  if (touched) check_static_limit(objects_[*touched], sample);
  record_force(sample, measured.clean_base, log);
  process_time(sample, log);
}

void RobotSite::process_time(const TouchSample& sample, const PredictionLog& log) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (objects_[i].learn_at && *objects_[i].learn_at <= sample.t) learn(objects_[i], sample.t);
    compare(i, sample, log.at(sample.t, i));
  }
}

void RobotSite::check_static_limit(RobotObject& object, const TouchSample& sample) {
  if (!options_.identifies || object.is_shared) return;
  const bool rests =
      object.monitor.is_touched() && !object.monitor.is_press() && !slides(object.monitor.phase());
  const auto& known = object.acknowledged.limiting_static_friction;
  const double limit = std::max(options_.learning.static_limit_ratio * known->value,
                                known->value + 3.0 * known->std.value_or(0.0));
  const double friction = sample.force_base.head<2>().norm();
  const bool is_beyond = rests && friction > limit + sensors_.enter_force;
  if (!is_beyond) {
    object.above_limit_since.reset();
    return;
  }
  if (!object.above_limit_since) object.above_limit_since = sample.t;
  if (sample.t - *object.above_limit_since < options_.learning.static_limit_time) return;
  const auto& supposed = object.learner.conservative_estimate().limiting_static_friction;
  if (!supposed || friction > supposed->value) object.learner.raise_static_limit(friction);
}

void RobotSite::plan_learning(RobotObject& object, MotionPhase before, bool was_touched, double t) {
  const MotionPhase now = object.monitor.phase();
  if (!was_touched && object.monitor.is_touched()) object.is_shared = false;
  if (!slides(before) && slides(now)) object.learn_at = t + options_.learning.delay_after_onset;
  if (slides(before) && !slides(now)) object.learn_at = t + options_.learning.delay_after_stop;
  if (was_touched && !object.monitor.is_touched())
    object.learn_at = t + options_.learning.delay_after_stop;
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
  object.learn_at.reset();
  if (is_sliding) object.learn_at = t + options_.learning.sliding_interval;
  object.last_learned = t;
  if (!options_.identifies || object.is_shared || !has_force_) return;
  const double begin = object.monitor.contact_begin();
  if (t - begin > options_.learning.max_contact_time) return;
  for (const UnusableInterval& bad : tip_.bad) {
    if (bad.begin > t || bad.end < begin) continue;
    note_once("the contact at " + at_time(begin) + " is not used to identify: " + bad.reason);
    return;
  }
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
    const bool is_near = objects_[i].touch(sample.p_base_tip).gap < options_.inputs.max_touch_gap;
    forces_.push_back({sample.t, i, is_touched || is_near ? measured.dot(direction) : 0.0,
                       rendered.dot(direction)});
  }
}

void RobotSite::compare(std::size_t index, const TouchSample& sample,
                        const Prediction& prediction) {
  RobotObject& object = objects_[index];
  const PoseEstimate estimate = object.estimate_pose(sample, prediction.pose);
  if (!options_.with_corrections) return;
  const PlanarPose here = planar_pose_of(estimate.T_base_object);
  const double gap =
      std::hypot(here.x - prediction.pose.x, here.y - prediction.pose.y) +
      options_.messages.rotation_radius * std::abs(wrapped(here.yaw - prediction.pose.yaw));
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
  seen.push_gap =
      (here.x - prediction.pose.x) * direction.x() + (here.y - prediction.pose.y) * direction.y();
  seen.position_std = estimate.std;
  const double allowed =
      options_.correction_switch.burst_bytes +
      options_.correction_switch.byte_budget * static_cast<double>(streaming_bytes_);
  const std::optional<CorrectionCase> which =
      object.correction_switch.evaluate(seen, static_cast<double>(sent_bytes_) / allowed);
  if (!which) return;
  const bool is_learned_lately =
      object.last_learned && sample.t - *object.last_learned <= kLearnAgain;
  if (!is_learned_lately && object.monitor.is_touched()) {
    const std::optional<double> planned = object.learn_at;
    learn(object, sample.t);
    if (planned && (!object.learn_at || *planned < *object.learn_at)) object.learn_at = planned;
  }
  std::optional<CorrectionMessage> message =
      compose(index, *which, sample, prediction.pose, gap, seen);
  if (!message) {
    object.correction_switch.note_nothing_to_send(*which, sample.t);
    return;
  }
  object.correction_switch.note_sent(*which, now_, message->sequence);
  outgoing_.push_back(std::move(*message));
}

std::optional<CorrectionMessage> RobotSite::compose(std::size_t index, CorrectionCase which,
                                                    const TouchSample& sample,
                                                    const PlanarPose& predicted, double gap,
                                                    const SiteComparison& seen) {
  RobotObject& object = objects_[index];
  const bool is_pose_current = seen.position_gap && gap > options_.messages.min_pose_error;
  const ParameterDifference changed =
      difference(sent_parameters(object.physics(), options_.gravity()), object.acknowledged,
                 options_.messages);
  CorrectionMessage message;
  message.t = sample.t;
  message.object = index;
  message.which = which;
  if (is_pose_current) {
    // Again, since newly identified contact parameters change it.
    message.pose = planar_pose_of(object.estimate_pose(sample, predicted).T_base_object);
    if (seen.operator_slides || slides(object.monitor.phase())) message.twist = object.twist();
  }
  message.parameters = parameters_to_send(
      changed, which, object.correction_switch.forces_agree(seen), options_.messages);
  if (which == CorrectionCase::touched_by_robot && message.pose) {
    const double inside = std::max(-object.touch(sample.p_base_tip).gap, 0.0);
    message.tool_retraction = -inside * object.monitor.direction_base();
  }
  const bool has_parameters = !is_empty(message.parameters);
  if (!message.pose && !has_parameters) return std::nullopt;
  if (!has_parameters && object.correction_switch.had_no_effect(which)) return std::nullopt;
  message.sequence = ++object.sequence;
  object.in_flight = RobotObject::InFlight{message.sequence, message.parameters};
  return message;
}

}  // namespace pcavr
