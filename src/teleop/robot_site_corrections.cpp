// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The robot's site: what is compared with the operator's site, and which correction is sent.
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "teleop/robot_site.hpp"
#include "teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

// Parameters older than this are identified again before a correction is composed [s]: its bytes
// should not carry what is about to change.
constexpr double kLearnAgain = 0.2;
// [s] Over which the tip's speed is measured to predict where the operator goes.
constexpr double kTipSpeedTime = 0.05;
// [s] Half width over which the tip's noise is averaged in a trial: the operator's command has
// none, and on a stiff face its force would count as an error of the stiffness.
constexpr double kTipSmoothing = 0.01;
// [stds] of a correction as it is displayed, above which it is worse than an error of that size.
// Three would also hold back corrections that help slow pushes.
constexpr double kGrowthStds = 1.0;
// [stds] of the estimate: a smaller difference of two poses at rest is noise.
constexpr double kRestStds = 2.0;
// Parameters are sent unless the prediction of a contact grows worse by this factor: its error has
// other causes too.
constexpr double kMaxErrorRatio = 1.5;

// [m] Between an object and a tool that is kept off it: more than both sites' poses differ by then.
constexpr double kOffDistance = 0.003;
// [s] after which a tool that is kept off is released whatever has been identified.
constexpr double kMaxKeptOff = 3.0;

/// That of the push; of the force itself where this has turned away from it, as in a hole, where
/// the tip goes on from a wall to the floor.
Eigen::Vector3d compared_direction(const Eigen::Vector3d& push_base,
                                   const Eigen::Vector3d& force_base) {
  constexpr double kMaxTangent = 1.73;  // 60 degrees: more than friction at the tip explains
  constexpr double kMinForce = 5.0;     // [N] a smaller one's direction is that of noise
  const double along = force_base.dot(push_base);
  const double across = (force_base - along * push_base).norm();
  const bool has_turned = across > kMinForce && across > kMaxTangent * std::abs(along);
  return has_turned ? Eigen::Vector3d(force_base.normalized()) : push_base;
}

}  // namespace

void RobotSite::acknowledge(RobotObject& object, const Prediction& prediction) {
  object.correction_switch.note_received(prediction.received);
  if (!object.in_flight || prediction.received != object.in_flight->sequence) return;
  overwrite(object.acknowledged, object.in_flight->parameters);
  object.in_flight.reset();
}

void RobotSite::record_force(const TouchSample& sample, const Eigen::Vector3d& clean_base,
                             const PredictionLog& log) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const bool is_touched = objects_[i].monitor.is_touched();
    const Eigen::Vector3d& rendered = log.at(sample.t, i).rendered_force_base;
    const double size = rendered.norm();
    if (!is_touched && size <= 0.0) continue;
    const Eigen::Vector3d measured = clean_base - bias_base_;
    const Eigen::Vector3d direction =
        is_touched ? compared_direction(objects_[i].monitor.direction_base(), measured)
                   : Eigen::Vector3d(rendered / size);
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
  const double gap = distance(here, prediction.pose, options_.messages.rotation_radius);
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
  if (!has_force(now_)) seen.robot_touches = seen.operator_touches = false;
  if (estimate.is_current) seen.position_gap = gap;
  seen.push_gap =
      (here.x - prediction.pose.x) * direction.x() + (here.y - prediction.pose.y) * direction.y();
  seen.position_std = estimate.std;
  if (object.is_full_state_due) {
    send_full_state(index, sample, prediction.pose, seen);
    return;
  }
  const double allowed =
      options_.correction_switch.burst_bytes +
      options_.correction_switch.byte_budget * static_cast<double>(streaming_bytes_);
  std::optional<CorrectionCase> which =
      object.correction_switch.evaluate(seen, static_cast<double>(sent_bytes_) / allowed);
  if (is_release_due(object, sample.t)) return send_release(index, sample.t);
  if (!which) which = take_unfinished_law(object, seen);
  if (!which) return;
  const bool is_learned_lately =
      object.last_learned && sample.t - *object.last_learned <= kLearnAgain;
  // A slide is identified at its own intervals: its force alone is no reason for more.
  const bool is_by_force = object.correction_switch.is_sliding_force();
  if (!is_learned_lately && object.monitor.is_touched() && !is_by_force) {
    const std::optional<double> planned = object.learn_at;
    learn(object, sample.t);
    if (planned && (!object.learn_at || *planned < *object.learn_at)) object.learn_at = planned;
  }
  if (object.identification && !is_by_force) return;  // it is composed with what that finds
  std::optional<CorrectionMessage> message =
      compose(index, *which, sample, prediction.pose, gap, seen);
  if (!message) {
    object.correction_switch.note_nothing_to_send(*which, sample.t);
    return;
  }
  object.correction_switch.note_sent(*which, now_, message->sequence);
  outgoing_.push_back(std::move(*message));
}

std::optional<CorrectionCase> RobotSite::take_unfinished_law(RobotObject& object,
                                                             const SiteComparison& seen) {
  const bool is_touched = object.monitor.is_touched() || seen.operator_touches;
  const bool is_identifying = object.learn_at || object.identification;
  if (is_touched || object.in_flight || is_identifying) return std::nullopt;
  return std::exchange(object.unfinished_law, std::nullopt);
}

bool RobotSite::is_release_due(const RobotObject& object, double t) {
  if (!object.kept_off_since) return false;
  const bool is_identified =
      !object.monitor.is_touched() && !object.learn_at && !object.identification;
  return is_identified || t - *object.kept_off_since > kMaxKeptOff;
}

void RobotSite::send_release(std::size_t index, double t) {
  RobotObject& object = objects_[index];
  object.kept_off_since.reset();
  CorrectionMessage message;
  message.t = t;
  message.object = index;
  message.which = CorrectionCase::phases_differ;
  message.tool_retraction = Eigen::Vector3d::Zero();
  message.parameters = object.parameters();
  message.sequence = ++object.sequence;
  object.in_flight = RobotObject::InFlight{message.sequence, message.parameters};
  object.correction_switch.note_sent(message.which, now_, message.sequence);
  outgoing_.push_back(std::move(message));
}

bool RobotSite::grows_beyond(double gap, std::size_t index, const CorrectionMessage& message) {
  RobotObject& object = objects_[index];
  if (!object.is_pushed() || !slides(object.monitor.phase())) return false;
  TriedCorrection tried;
  tried.t = message.t;
  tried.until = now_ + round_trip_;
  tried.object = index;
  for (const RobotObject& other : objects_) {
    tried.poses.push_back(planar_pose_of(other.T_base_object()));
  }
  tried.poses[index] = *message.pose;
  tried.twist = message.twist.value_or(Eigen::Vector3d::Zero());
  tried.physics = object.physics();
  tried.lateral_base = Eigen::Vector3d::UnitZ().cross(object.monitor.direction_base());
  tried.position_std = object.latest().position_std / std::sqrt(3.0);
  tried.rotation_std = object.latest().rotation_std;
  tried.p_base_tip = [this](double t) { return p_base_tip_at(t); };
  const std::optional<double> displayed = trial_.displayed_std(tried);
  return displayed && kGrowthStds * *displayed > gap;
}

double RobotSite::resting_noise(const RobotObject& object, const TouchSample& sample,
                                const SiteComparison& seen) const {
  if (!seen.operator_slides) return kRestStds * seen.position_std;
  // A slide is noticed here after it began: up to what is no slide yet, and the tip's path since
  // the latest frame, the operator's site may be ahead and right.
  return options_.phases.slow_slide_displacement +
         (sample.p_base_tip - tip_.at(object.latest().t)).norm();
}

bool RobotSite::worsens_contacts(std::size_t index, const ObjectParameters& parameters) {
  const RobotObject& object = objects_[index];
  if (is_empty(parameters) || object.is_shared || !has_force(now_)) return false;
  ObjectParameters next = object.acknowledged;
  overwrite(next, parameters);
  const BodyPhysics before = object.physics_with(object.acknowledged);
  BodyPhysics after = object.physics_with(next);
  const Eigen::Vector3d offset = after.surface_offset;
  for (const RobotObject::SeenContact& seen : object.seen_contacts()) {
    const double end = std::min(seen.begin + RobotObject::kMaxSeenTime, processed_);
    if (seen.begin < tip_.t().front()) continue;
    RecordedContact contact{.object = index,
                            .begin = seen.begin,
                            .end = end,
                            .T_base_start = seen.T_base_start,
                            .direction_base = seen.direction_base,
                            .seen = seen.poses,
                            .force = force_.between(seen.begin, end),
                            .bias_base = bias_base_,
                            .force_resolution = sensors_.enter_force,
                            .p_base_tip = [this](double t) { return smooth_tip(t); }};
    // The surface is measured on the face that is touched now: another one's need not change.
    const bool is_newest = &seen == &object.seen_contacts().back();
    after.surface_offset = is_newest ? offset : before.surface_offset;
    const std::optional<double> error = trial_.error_of(contact, after);
    // One that can't be noticed is right whatever the error was: a trial less.
    if (!error || *error <= 1.0) continue;
    if (*error > kMaxErrorRatio * *trial_.error_of(contact, before)) return true;
  }
  return false;
}

Eigen::Vector3d RobotSite::smooth_tip(double t) const {
  const std::span<const double> times = tip_.t();
  const auto first = std::lower_bound(times.begin(), times.end(), t - kTipSmoothing);
  const auto last = std::upper_bound(first, times.end(), t + kTipSmoothing);
  const auto count = static_cast<std::size_t>(last - first);
  if (count < 3) return tip_.at(t);
  const auto path = tip_.p_base().subspan(static_cast<std::size_t>(first - times.begin()), count);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double sum_t = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += path[i];
    sum_t += first[static_cast<std::ptrdiff_t>(i)] - t;
  }
  const Eigen::Vector3d velocity = (path.back() - path.front()) / (*(last - 1) - *first);
  return (sum - sum_t * velocity) / static_cast<double>(count);
}

Eigen::Vector3d RobotSite::p_base_tip_at(double t) const {
  const double end = tip_.t().back();
  if (t <= end) return tip_.at(t);
  // The operator goes on as before, as far as is known here.
  const Eigen::Vector3d velocity = (tip_.at(end) - tip_.at(end - kTipSpeedTime)) / kTipSpeedTime;
  return tip_.at(end) + (t - end) * velocity;
}

void RobotSite::send_full_state(std::size_t index, const TouchSample& sample,
                                const PlanarPose& predicted, const SiteComparison& seen) {
  RobotObject& object = objects_[index];
  if (!seen.position_gap) return;
  object.is_full_state_due = false;
  CorrectionMessage message;
  message.t = sample.t;
  message.object = index;
  message.pose = planar_pose_of(object.estimate_pose(sample, predicted).T_base_object);
  message.twist = object.twist();
  message.parameters = object.parameters();
  message.sequence = ++object.sequence;
  object.in_flight = RobotObject::InFlight{message.sequence, message.parameters};
  object.correction_switch.note_sent(message.which, now_, message.sequence);
  outgoing_.push_back(std::move(message));
}

std::optional<CorrectionMessage> RobotSite::compose(std::size_t index, CorrectionCase which,
                                                    const TouchSample& sample,
                                                    const PlanarPose& predicted, double gap,
                                                    const SiteComparison& seen) {
  RobotObject& object = objects_[index];
  const bool is_pose_current = seen.position_gap && gap > options_.messages.min_pose_error &&
                               !object.correction_switch.is_sliding_force();
  const ParameterDifference changed =
      difference(object.parameters(), object.acknowledged,
                 object.in_flight ? &object.in_flight->parameters : nullptr, options_.messages);
  CorrectionMessage message;
  message.t = sample.t;
  message.object = index;
  message.which = which;
  if (is_pose_current) {
    // Again, since newly identified contact parameters change it.
    message.pose = planar_pose_of(object.estimate_pose(sample, predicted).T_base_object);
    if (seen.operator_slides || slides(object.monitor.phase())) message.twist = object.twist();
    const bool is_noise = seen.robot_slides ? grows_beyond(gap, index, message)
                                            : gap < resting_noise(object, sample, seen);
    if (is_noise) {
      message.pose.reset();
      message.twist.reset();
    }
  }
  message.parameters = parameters_to_send(
      changed, which, object.correction_switch.forces_agree(seen), options_.messages);
  if (worsens_contacts(index, message.parameters)) message.parameters = {};
  if (which == CorrectionCase::touched_by_robot && message.pose) {
    const double inside = std::max(-object.touch(sample.p_base_tip).gap, 0.0);
    message.tool_retraction = -inside * object.monitor.direction_base();
  }
  const bool has_parameters = !is_empty(message.parameters);
  if (options_.correction_switch.keeps_off && which == CorrectionCase::phases_differ &&
      has_parameters && object.is_pushed() && !object.kept_off_since) {
    const double inside = std::max(-object.touch(sample.p_base_tip).gap, 0.0);
    message.tool_retraction = -(inside + kOffDistance) * object.monitor.direction_base();
    object.kept_off_since = sample.t;
  }
  const bool is_unfinished =
      message.parameters.contact_stiffness || !contact_law_of(object.learner.known());
  if (is_unfinished && object.monitor.is_touched()) object.unfinished_law = which;
  if (!message.pose && !has_parameters) return std::nullopt;
  if (!has_parameters && object.correction_switch.had_no_effect(which)) return std::nullopt;
  message.sequence = ++object.sequence;
  object.in_flight = RobotObject::InFlight{message.sequence, message.parameters};
  return message;
}

}  // namespace pcavr
