// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/robot_site.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pcavr/core/check.hpp"

#include "teleop/told_parameters.hpp"

namespace pcavr {
namespace {

// A force may be an object's whose tracked surface is within this of the tip's [m]: an object that
// slides at 0.1 m/s goes that far between being seen and being known.
constexpr double kReach = 0.010;
// The bias is followed only while no object is this near [m], and this slowly [s].
constexpr double kFreeClearance = 0.002;
constexpr double kBiasTime = 0.25;
constexpr double kDriftFloor = 0.3;  // [N] that a bias may wander unseen
constexpr double kEnterSigmas = 5.0;
// A frame's tags are found and its pose is known this much later [s].
constexpr double kTrackingTime = 0.030;
// Looks without a force [s].
constexpr double kLookInterval = 0.005;
constexpr double kTouchClearance = 0.0005;  // [m]
// Free time before a contact that goes with its record [s].
constexpr double kBefore = 0.3;
// Of a contact that goes on for longer [s], only the beginning teaches: the work must not grow with
// its length, and memory of the force reaches no further back.
constexpr double kMaxLearnedTime = 60.0;
// A contact is learned from once more after it has ended [s].
constexpr double kOldContact = 1.0;
// When something new may be told after a slide's begin, while it lasts, and after its end [s].
constexpr double kAfterOnset = 0.12;
constexpr double kWhileSliding = 0.3;
constexpr double kAfterStop = 0.08;
constexpr double kLearnAgain = 0.2;
// A friction beyond its limit by this share, for this long, refutes the limit.
constexpr double kRefuted = 1.05;
constexpr double kWithstood = 0.05;  // [s]
// A place is worth sending along from here [m].
constexpr double kPlaceMatters = 1e-4;
// A turn counts as the way of a point this far out [m].
constexpr double kTurnRadius = 0.07;
// Share of streaming's bytes that corrections may take.
constexpr double kBudget = 0.01;
// Bytes that may be sent before the budget counts: a few corrections at the start.
constexpr double kBurst = 400.0;

double wrapped(double angle) { return std::remainder(angle, 2.0 * M_PI); }

bool slides(MotionPhase phase) { return phase == MotionPhase::sliding; }

std::string at_time(double t) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", t);
  return text;
}

/// Damping over stiffness [s/m]; of a linear law, at the depth of a millimetre.
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
  const std::size_t cycles = forgotten_ + rows_.size() / objects_;
  const double cycle =
      std::clamp(std::round((t - start_) / step_) - 1.0, 0.0, static_cast<double>(cycles - 1));
  return static_cast<std::size_t>(cycle);
}

const Prediction& PredictionLog::at(double t, std::size_t object) const {
  const std::size_t cycle = cycle_at(t);
  PCAVR_REQUIRE(cycle >= forgotten_, t, cycle, forgotten_);
  return rows_[(cycle - forgotten_) * objects_ + object];
}

void PredictionLog::forget_before(double t) {
  // Rarely, and many at once: what is kept has to be moved.
  constexpr std::size_t kAtOnce = 4096;  // cycles: seconds
  if (rows_.empty() || cycle_at(t) < forgotten_ + kAtOnce) return;
  const std::size_t old = cycle_at(t) - forgotten_;
  rows_.erase(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(old * objects_));
  forgotten_ += old;
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
      next_look_(start),
      start_(start),
      streamed_frames_(input.objects.size(), 0) {
  const SwitchOptions gate = switch_options(options, monitor_);
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    objects_.emplace_back(input.objects[i], physics[i], monitor_, gate, findings.force_ceiling,
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
    confirm(objects_[i], log.at(now, i));
  }
  for (; next_sample_ < force_.size() && force_.t(next_sample_) + force_.lag() <= now;
       ++next_sample_) {
    if (force_.t(next_sample_) < start_) continue;
    streaming_bytes_ += bytes_of_wrench_sample();
    if (!has_force_) continue;
    // No frame that is newer than the force: its way would count twice.
    look(std::min(now - kTrackingTime, force_.t(next_sample_)));
    take_sample(next_sample_, log);
  }
  force_.forget_before(now - force_.lag() - kMaxLearnedTime - kBefore - kOldContact);
  if (!has_force_ && now >= next_look_) {
    next_look_ += kLookInterval;
    look(now - kTrackingTime);
    see_without_force(now - kTrackingTime);
    take_instant({now - kTrackingTime, tip_.at(now - kTrackingTime), Eigen::Vector3d::Zero()}, log);
  }
  return std::move(outgoing_);
}

double RobotSite::looks_back_to() const {
  // The next sample is later than now_ - lag; without a force the sites look back kTrackingTime.
  return now_ - force_.lag() - kTrackingTime - kLookInterval;
}

void RobotSite::look(double t) {
  for (RobotObject& object : objects_) object.look(t);
}

void RobotSite::confirm(RobotObject& object, const Prediction& prediction) {
  if (!object.on_its_way || prediction.received != object.on_its_way->sequence) return;
  overwrite(object.told, object.on_its_way->parameters);
  object.on_its_way.reset();
}

void RobotSite::see_without_force(double t) {
  for (RobotObject& object : objects_) {
    const bool is_near = object.reach(tip_.at(t)).clearance < kTouchClearance;
    object.monitor.see(t, object.is_seen_moving(), is_near);
  }
}

std::optional<std::size_t> RobotSite::attribute(const TouchSample& sample,
                                                std::vector<Reach>& reaches) {
  std::optional<std::size_t> nearest, held;
  std::size_t touching = 0;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    reaches.push_back(objects_[i].reach(sample.p_base_tip));
    if (reaches[i].clearance < kTouchClearance) ++touching;
    if (!nearest || reaches[i].clearance < reaches[*nearest].clearance) nearest = i;
    if (!held && objects_[i].monitor.is_touched()) held = i;
  }
  // What is touched stays so until it is let go.
  if (held) nearest = held;
  if (!nearest || (!held && reaches[*nearest].clearance > kReach)) return std::nullopt;
  const bool has_force = sample.force_base.norm() > monitor_.enter_force;
  if (touching > 1 && has_force && !objects_[*nearest].is_shared) {
    note_once("the tip lies at " + std::to_string(touching) + " objects at " + at_time(sample.t) +
              ": the force is not one object's and teaches nothing");
    objects_[*nearest].is_shared = true;
  }
  return nearest;
}

void RobotSite::follow_bias(const TouchSample& sample, const std::vector<Reach>& reaches) {
  const bool is_small = sample.force_base.norm() < monitor_.enter_force;
  bool is_clear = true;
  for (const Reach& reach : reaches) is_clear = is_clear && reach.clearance > kFreeClearance;
  if (is_clear && is_small) {
    // From the mean of what has been seen to a mean over kBiasTime.
    bias_since_ += monitor_.interval;
    const double gain = monitor_.interval / std::min(std::max(bias_since_, 0.02), kBiasTime);
    bias_base_ += gain * sample.force_base;
  }
  bool is_far = !is_small;
  for (const Reach& reach : reaches) is_far = is_far && reach.clearance > kReach;
  far_samples_ = is_far ? far_samples_ + 1 : 0;
  if (static_cast<double>(far_samples_) * monitor_.interval > kWithstood) {
    note_once("a force far from every object (first at " + at_time(sample.t) +
              "): it belongs to none of them");
    far_samples_ = 0;
  }
}

void RobotSite::take_sample(std::size_t index, const PredictionLog& log) {
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
    if (touched != i) object.monitor.see(sample.t, object.is_seen_moving(), false);
    plan_learning(object, before, was_touched, sample.t);
  }
  if (!touched || !objects_[*touched].monitor.is_touched()) follow_bias(sample, reaches);
  if (touched) watch_limit(objects_[*touched], sample);
  record_force(sample, measured.clean_base, log);
  take_instant(sample, log);
}

void RobotSite::take_instant(const TouchSample& sample, const PredictionLog& log) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (objects_[i].learn_at <= sample.t) learn(objects_[i], sample.t);
    judge(i, sample, log.at(sample.t, i));
  }
}

void RobotSite::watch_limit(RobotObject& object, const TouchSample& sample) {
  if (!options_.identifies || object.is_shared) return;
  const bool rests =
      object.monitor.is_touched() && !object.monitor.is_press() && !slides(object.monitor.phase());
  const auto& told = object.told.limiting_static_friction;
  const double limit =
      std::max(kRefuted * told->value, told->value + 3.0 * told->deviation.value_or(0.0));
  const double friction = sample.force_base.head<2>().norm();
  const bool is_beyond = rests && friction > limit + monitor_.enter_force;
  if (!is_beyond) {
    object.withstood_since = 1e300;
    return;
  }
  object.withstood_since = std::min(object.withstood_since, sample.t);
  if (sample.t - object.withstood_since < kWithstood) return;
  const auto& supposed = object.learner.supposed().limiting_static_friction;
  if (!supposed || friction > supposed->value) object.learner.withstand(friction);
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
              " moved together: the force is not one object's and teaches nothing");
  }
}

void RobotSite::learn(RobotObject& object, double t) {
  const bool goes_on = object.monitor.is_touched() && slides(object.monitor.phase());
  object.learn_at = goes_on ? t + kWhileSliding : 1e300;
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
    const Eigen::Vector3d& felt = log.at(sample.t, i).felt_base;
    const double size = felt.norm();
    if (!is_touched && size <= 0.0) continue;
    const Eigen::Vector3d direction =
        is_touched ? objects_[i].monitor.direction_base() : Eigen::Vector3d(felt / size);
    const Eigen::Vector3d measured = clean_base - bias_base_;
    const bool is_near = objects_[i].reach(sample.p_base_tip).clearance < kReach;
    forces_.push_back(
        {sample.t, i, is_touched || is_near ? measured.dot(direction) : 0.0, felt.dot(direction)});
  }
}

void RobotSite::judge(std::size_t index, const TouchSample& sample, const Prediction& prediction) {
  RobotObject& object = objects_[index];
  const KnownPlace place = object.place_at(sample);
  if (!options_.with_corrections) return;
  const PlanarPlace here = place_of(place.T_base_object);
  const double gap = std::hypot(here.x - prediction.place.x, here.y - prediction.place.y) +
                     kTurnRadius * std::abs(wrapped(here.yaw - prediction.place.yaw));
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
  if (place.is_current) seen.position_gap = gap;
  seen.position_sigma = place.sigma;
  const double allowed = kBurst + kBudget * static_cast<double>(streaming_bytes_);
  const std::optional<CorrectionCase> which =
      object.gate.judge(seen, static_cast<double>(sent_bytes_) / allowed);
  if (!which) return;
  if (sample.t - object.last_learned > kLearnAgain && object.monitor.is_touched()) {
    const double planned = object.learn_at;
    learn(object, sample.t);
    object.learn_at = std::min(object.learn_at, planned);
  }
  std::optional<CorrectionMessage> message =
      compose(index, *which, sample, place, gap, seen.operator_slides);
  if (!message) {
    object.gate.note_silent(*which, sample.t);
    return;
  }
  object.gate.note_sent(*which, now_);
  outgoing_.push_back(std::move(*message));
}

std::optional<CorrectionMessage> RobotSite::compose(std::size_t index, CorrectionCase which,
                                                    const TouchSample& sample,
                                                    const KnownPlace& judged, double gap,
                                                    bool operator_slides) {
  RobotObject& object = objects_[index];
  const bool is_place_current = judged.is_current && (gap > kPlaceMatters);
  const ParameterDifference news = difference(told_parameters(object.physics()), object.told);
  CorrectionMessage message;
  message.t = sample.t;
  message.object = index;
  message.which = which;
  if (is_place_current) {
    // Anew: what was just learned of the contact moves the face.
    message.place = place_of(object.place_at(sample).T_base_object);
    if (operator_slides || slides(object.monitor.phase())) message.twist = object.twist();
  }
  if (news.has_contact) overwrite(message.parameters, news.contact);
  if (news.has_friction) overwrite(message.parameters, news.friction);
  if (which == CorrectionCase::touched_by_robot && message.place) {
    const double inside = std::max(-object.reach(sample.p_base_tip).clearance, 0.0);
    message.lead_out = -inside * object.monitor.direction_base();
  }
  if (!message.place && is_empty(message.parameters)) return std::nullopt;
  message.sequence = ++object.sequence;
  object.on_its_way = RobotObject::OnItsWay{message.sequence, message.parameters};
  return message;
}

}  // namespace pcavr
