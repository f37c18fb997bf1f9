// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/robot_site.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/check.hpp"

#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxFailures = 16;  // that were not taken

// Update interval without a force: shorter than that of any camera [s].
constexpr double kCameraInterval = 0.005;
// A force far from every object is noted after this [s]: not a spike.
constexpr double kMinFarForceTime = 0.05;
// Shortest averaging of the bias at the start [s]: some ten samples of a typical sensor.
constexpr double kMinBiasTime = 0.02;
// No force arrived for this long [s]: the camera alone is used.
constexpr double kForceSilence = 0.2;
// Time after a contact's end at which all its samples are there [s].
constexpr double kSettled = 0.5;
// Samples from before the operator's first cycle that one cycle processes: those of a second, which
// wait when a session begins, would take milliseconds of one.
constexpr int kMaxOldSamples = 32;

/// Damping over stiffness [s/m]; of a linear law, at a penetration of 1 mm.
double relative_damping(const ObjectParameters& known) {
  if (!known.contact_stiffness || !known.contact_damping) return 0.0;
  const double ratio = known.contact_damping->value / known.contact_stiffness->value;
  const bool is_linear = !known.contact_exponent || known.contact_exponent->value == 1.0;
  return is_linear ? ratio / 1e-3 : ratio;
}

SensorProperties sensor_properties(const TipStream& tip, const ForceStream& force,
                                   const TouchOptions& options) {
  SensorProperties sensors;
  sensors.tip_noise = std::max(tip.noise(), 1e-6);
  sensors.interval = force.interval();
  sensors.force_noise = force.noise();
  sensors.correlated = force.correlated();
  sensors.enter_force = std::max(options.contact_stds * force.smooth_noise(), options.force_drift);
  return sensors;
}

std::vector<TeleopObject> without_tracking(const std::vector<TeleopObject>& objects) {
  std::vector<TeleopObject> world;
  for (const TeleopObject& object : objects) {
    world.push_back({object.name,
                     object.model,
                     object.T_base_object,
                     object.parameters,
                     {},
                     object.is_movable});
  }
  return world;
}

}  // namespace

RobotSite::RobotSite(const TeleopInput& world, const TeleopOptions& options,
                     const std::vector<BodyPhysics>& physics, double start, Background background)
    : options_(options),
      background_(std::move(background)),
      world_(without_tracking(world.objects)),
      tip_(options.sensors.tip_noise, options.inputs),
      force_(options.sensors.force_noise),
      watch_(world_, world.tool_radius, options, background_),
      trial_(world, physics, options),
      sensors_(sensor_properties(tip_, force_, options.touch)),
      last_tracked_(world_.size()),
      tracked_outliers_(world_.size(), PoseOutlierFilter(PoseSource::stream)),
      force_seen_(start),
      free_since_(start),
      processed_(std::nextafter(start, start - 1.0)),
      next_camera_update_(start),
      now_(start),
      start_(start),
      round_trip_(options.round_trip()) {
  force_.set_offset(watch_.force().offset);
  for (std::size_t i = 0; i < world_.size(); ++i) {
    objects_.emplace_back(world_[i], physics[i], options_, sensors_, world.tool_radius, start);
  }
}

void RobotSite::note_once(const std::string& text) {
  if (std::find(notes_.begin(), notes_.end(), text) == notes_.end()) notes_.push_back(text);
}

void RobotSite::note_failure(const char* task, const Error& error) {
  const std::string line =
      std::string(task) + " failed, and what was known before is kept: " + error.message;
  note_once(line);
  // A replay takes none of them: memory stays bounded however often a task fails.
  if (failures_.size() < kMaxFailures) failures_.push_back(line);
}

InputFindings RobotSite::findings() {
  const Expected<InputFindings> found = watch_.findings();
  if (found) return *found;
  note_failure(InputWatch::kTask, found.error());
  return {};
}

bool RobotSite::is_next(const char* what, double t, bool is_finite, std::optional<double>& last) {
  if (!is_finite || !std::isfinite(t) || (last && t <= *last)) {
    note_once(std::string("samples of the ") + what +
              " that are not finite numbers, or whose stamps do not ascend, are ignored");
    return false;
  }
  last = t;
  return true;
}

void RobotSite::add_tool(double t, const Eigen::Vector3d& p_base_tip,
                         const std::optional<Eigen::Quaterniond>& q_base_tool) {
  if (!is_next("tool", t, p_base_tip.allFinite(), last_tool_)) return;
  tip_.add(t, p_base_tip);
  watch_.add_tool(t, p_base_tip, q_base_tool);
}

void RobotSite::add_wrench(double t, const Eigen::Vector3d& force_base) {
  if (!is_next("wrench", t, force_base.allFinite(), last_wrench_)) return;
  force_.add(t, force_base);
  watch_.add_force(t, force_base);
  has_new_force_ = true;
  if (t >= start_) streaming_bytes_ += bytes_of_wrench_sample();
}

void RobotSite::add_tracked(std::size_t object, const TrackedPose& pose) {
  PCAVR_REQUIRE(object < objects_.size(), object, objects_.size());
  const bool is_finite = pose.T_base_object.translation().allFinite();
  if (!is_next("tracking", pose.t, is_finite, last_tracked_[object])) return;
  for (const TrackedPose& accepted : tracked_outliers_[object].add(pose)) {
    objects_[object].pose().add_tracked(accepted);
    watch_.add_tracked(object, accepted);
  }
  streaming_bytes_ += bytes_of_tracked_pose();
}

std::vector<CorrectionMessage> RobotSite::advance(double now, const PredictionLog& log) {
  outgoing_.clear();
  now_ = now;
  if (std::exchange(has_new_force_, false)) force_seen_ = now;
  update_sensors();
  for (std::size_t i = 0; i < objects_.size(); ++i)
    objects_[i].corrections().acknowledge(log.at(now, i).received);
  if (tip_.empty()) return {};
  if (has_force(now)) {
    process_forces(now, log);
  } else if (now >= next_camera_update_) {
    process_camera(now, log);
  }
  if (is_any_touched()) {
    free_since_ = now;
    has_new_contact_ = true;
  } else if (now - free_since_ > kSettled) {
    examine_inputs_at(now);
  }
  force_.discard_before(now - force_.lag() - stored_time());
  tip_.discard_before(now - force_.lag() - stored_time());
  return std::move(outgoing_);
}

bool RobotSite::would_wait(double now) const {
  const auto waits = [now](const RobotObject& object) {
    return object.knowledge().would_wait(now);
  };
  return watch_.would_wait(now) || (pending_trial_ && pending_trial_->would_wait(now)) ||
         std::any_of(objects_.begin(), objects_.end(), waits);
}

void RobotSite::set_round_trip(double round_trip) {
  round_trip_ = round_trip;
  for (RobotObject& object : objects_) object.corrections().decision().set_round_trip(round_trip);
}

void RobotSite::idle(double now) {
  now_ = now;
  processed_ = std::max(processed_, now);
  update_tracking(now);
  force_.discard_before(now - force_.lag() - stored_time());
  tip_.discard_before(now - force_.lag() - stored_time());
}

void RobotSite::restart(double now) {
  now_ = now;
  processed_ = std::max(processed_, now);
  pending_trial_.reset();
  for (RobotObject& object : objects_) object.corrections().restart();
}

bool RobotSite::is_any_touched() const {
  return std::any_of(objects_.begin(), objects_.end(),
                     [](const RobotObject& object) { return object.monitor().is_touched(); });
}

bool RobotSite::has_force(double now) const {
  return !watch_.fault() && now - force_seen_ < kForceSilence;
}

void RobotSite::update_sensors() {
  sensors_ = sensor_properties(tip_, force_, options_.touch);
  for (RobotObject& object : objects_) {
    if (object.monitor().is_touched()) continue;
    object.monitor().set_sensors(sensors_);
    object.corrections().decision().set_force_floor(sensors_.enter_force);
  }
}

void RobotSite::process_forces(double now, const PredictionLog& log) {
  int old = 0;
  while (const std::optional<ForceStream::Sample> sample = force_.next(processed_, now, tip_)) {
    // No frame newer than the force: the displacement since then would count twice.
    update_tracking(sample->t);
    process_sample(*sample, log);
    processed_ = sample->t;
    if (sample->t < log.start() && ++old == kMaxOldSamples) return;
  }
}

void RobotSite::process_camera(double now, const PredictionLog& log) {
  next_camera_update_ = std::max(next_camera_update_ + kCameraInterval, now - kCameraInterval);
  const double t = now - options_.pose.tracking_latency;
  if (t <= processed_) return;
  for (RobotObject& object : objects_) object.monitor().lose_force();
  update_tracking(t);
  update_from_camera(t);
  process_time({t, tip_.at(t), Eigen::Vector3d::Zero()}, log);
  processed_ = t;
}

void RobotSite::examine_inputs_at(double t) {
  const double offset = watch_.force().offset;
  const bool had_fault = watch_.fault().has_value();
  const bool has_changed = watch_.examine(t, has_new_contact_);
  has_new_contact_ = false;
  if (const auto failure = watch_.take_failure()) note_failure(InputWatch::kTask, *failure);
  if (!has_changed) return;
  if (watch_.fault()) {
    if (!had_fault) force_fault_since_ = t;
    for (RobotObject& object : objects_) object.forget_learned();
    return;
  }
  const double change = watch_.force().offset - offset;
  force_.set_offset(watch_.force().offset);
  if (change != 0.0) learn_again(change);
}

double RobotSite::oldest_needed() const { return std::min(processed_, now_); }

void RobotSite::update_tracking(double t) {
  for (RobotObject& object : objects_) object.pose().update_tracking(t, watch_.camera().offset);
}

void RobotSite::update_from_camera(double t) {
  for (RobotObject& object : objects_) {
    const bool is_near = object.pose().touch(tip_.at(t)).gap < options_.touch.touch_clearance;
    object.monitor().update_from_camera(t, object.pose().is_seen_moving(), is_near);
  }
}

std::optional<TouchedBody> RobotSite::attribute(const TouchSample& sample,
                                                std::vector<Touch>& touches) const {
  for (const RobotObject& object : objects_)
    touches.push_back(object.pose().touch(sample.p_base_tip));
  // A contact stays with its object until it ends.
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (objects_[i].monitor().is_touched()) return TouchedBody{i, false};
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
    if (!std::exchange(has_far_force_, true)) {
      notes_.push_back("a force far from every object (first at " + at_time(sample.t) +
                       "): it is assigned to none of them");
    }
    far_samples_ = 0;
  }
}

void RobotSite::process_sample(const ForceStream::Sample& measured, const PredictionLog& log) {
  TouchSample sample{measured.t, measured.p_base_tip, measured.smooth_base - bias_base_};
  std::vector<Touch> touches;
  const std::optional<TouchedBody> attributed = attribute(sample, touches);
  std::optional<std::size_t> touched;
  if (attributed) touched = attributed->body;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    RobotObject& object = objects_[i];
    const MotionPhase before = object.monitor().phase();
    const bool was_touched = object.monitor().is_touched();
    object.monitor().step(
        {sample.t, sample.p_base_tip, sample.force_base, touches[i].inward_base, touched == i},
        object.knowledge().parameters().limiting_static_friction,
        relative_damping(object.knowledge().parameters()));
    if (touched != i)
      object.monitor().update_from_camera(sample.t, object.pose().is_seen_moving(), false);
    plan_learning(object, before, was_touched, sample.t);
    if (!was_touched && object.monitor().is_touched() && attributed && attributed->is_ambiguous) {
      object.set_shared(true);
      note_once("the tip touches " + object.name() + " and another object at " + at_time(sample.t) +
                ": their shared force is not used to identify");
    }
  }
  if (!touched || !objects_[*touched].monitor().is_touched()) estimate_bias(sample, touches);
  if (touched) check_static_limit(objects_[*touched], sample);
  record_force(sample, measured.clean_base, log);
  process_time(sample, log);
}

void RobotSite::process_time(const TouchSample& sample, const PredictionLog& log) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    RobotObject& object = objects_[i];
    if (object.knowledge().is_identification_due(sample.t)) apply_identification(object);
    // Each begins from the knowledge, and the contact's replaces it.
    if (!object.knowledge().has_identification()) search_friction(object, sample.t);
    if (object.knowledge().is_due(sample.t)) learn(object, sample.t);
    update_first_law(object, sample.t);
    if (sample.t < log.start()) continue;  // a correction of that time would come too late
    compare(i, sample, log.at(sample.t, i));
  }
}

std::vector<std::string> RobotSite::notes() const {
  std::vector<std::string> notes = notes_;
  if (force_fault_since_ && watch_.fault()) {
    notes.push_back(fmt::format("the force is not used from {} on: {}; {}",
                                at_time(*force_fault_since_), watch_.fault()->error.message,
                                watch_.fault()->error.hint));
  }
  if (const double turn = watch_.suspected_turn(); turn > 0.0) {
    notes.push_back(
        fmt::format("the force may be turned by up to {:.0f} degrees: friction at the tip is not "
                    "identified; check how the force sensor is mounted",
                    turn * 180.0 / std::numbers::pi));
  }
  const auto note_offset = [&notes](const char* what, const AppliedOffset& applied) {
    if (!applied.since) return;
    notes.push_back(
        fmt::format("{} lags by {:.1f} +- {:.1f} ms by its stamps: corrected from {} on", what,
                    1e3 * applied.offset, 1e3 * applied.std, at_time(*applied.since)));
  };
  for (std::size_t i = 0; i < world_.size(); ++i) {
    const PoseOutliers& outliers = tracked_outliers_[i].outliers();
    if (outliers.count > 0) {
      notes.push_back(fmt::format("tracking of {}: {}: {} ignored", world_[i].name,
                                  describe(outliers), outliers.count));
    }
  }
  note_offset("tracking", watch_.camera());
  note_offset("the force", watch_.force());
  return notes;
}

}  // namespace pcavr
