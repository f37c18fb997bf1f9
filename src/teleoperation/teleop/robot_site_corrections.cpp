// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The robot's site: what is compared with the operator's site, and which correction is sent.
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/smoothed_values.hpp"

#include "teleoperation/teleop/robot_site.hpp"
#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

// Parameters older than this are identified again before a correction is composed [s]: its bytes
// should not carry what is about to change.
constexpr double kLearnAgain = 0.2;
// [s] Time over which the tip's speed is measured to predict where the operator goes.
constexpr double kTipSpeedTime = 0.05;
// [s] Half width over which the tip's noise is averaged in a trial: the operator's command has
// none, and on a stiff face its force would count as an error of the stiffness.
constexpr double kTipSmoothing = 0.01;
// Smallest half width in intervals of a slow tip's samples: as many as a local line needs.
constexpr double kMinSmoothedIntervals = 3.0;
// [stds] of the estimate: a smaller difference of two poses at rest is noise.
constexpr double kRestStds = 2.0;
// [m] Distance between an object and a tool that is kept off it: more than both sites' poses differ
// by then.
constexpr double kOffDistance = 0.003;
// [s] after which a tool that is kept off is released whatever has been identified.
constexpr double kMaxKeptOff = 3.0;

/// The tip's measured path, copied for a trial.
class TriedPath {
 public:
  /// The path of [begin, end] [s]; after that the operator goes on as before, as far as is known
  /// here.
  TriedPath(const TipStream& tip, double begin, double end) {
    const std::span<const double> t = tip.t();
    const auto from = std::upper_bound(t.begin(), t.end(), begin);
    const auto first = static_cast<std::size_t>(from == t.begin() ? 0 : from - t.begin() - 1);
    const auto last = static_cast<std::size_t>(std::lower_bound(from, t.end(), end) - t.begin());
    const std::size_t count = std::min(last + 1, t.size()) - first;
    t_.assign(t.begin() + first, t.begin() + first + count);
    p_base_.assign(tip.p_base().begin() + first, tip.p_base().begin() + first + count);
    velocity_base_ = (p_base_.back() - tip.at(t_.back() - kTipSpeedTime)) / kTipSpeedTime;
  }
  [[nodiscard]] Eigen::Vector3d at(double t) const {
    if (t <= t_.back()) return PathView(t_, p_base_).at(t);
    return p_base_.back() + (t - t_.back()) * velocity_base_;
  }
  /// Position without the noise of its measurement, where there are samples around.
  [[nodiscard]] Eigen::Vector3d smooth_at(double t, double half_width) const {
    return smooth_point_at(t_, p_base_, t, half_width).value_or(at(t));
  }

 private:
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> p_base_;
  Eigen::Vector3d velocity_base_;
};

/// Direction of the push; that of the force itself where it has turned away from the push, as in a
/// hole, where the tip goes on from a wall to the floor.
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

void RobotSite::record_force(const TouchSample& sample, const Eigen::Vector3d& clean_base,
                             const PredictionLog& log) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const bool is_touched = objects_[i].monitor().is_touched();
    const Eigen::Vector3d& rendered = log.at(sample.t, i).rendered_force_base;
    const double size = rendered.norm();
    if (!is_touched && size <= 0.0) continue;
    const Eigen::Vector3d measured = clean_base - bias_base_;
    const Eigen::Vector3d direction =
        is_touched ? compared_direction(objects_[i].monitor().direction_base(), measured)
                   : Eigen::Vector3d(rendered / size);
    const bool is_near =
        objects_[i].pose().touch(sample.p_base_tip).gap < options_.inputs.max_touch_gap;
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
  seen.robot_slides = slides(object.monitor().phase());
  seen.operator_slides = slides(prediction.phase);
  seen.robot_touches = object.monitor().is_touched();
  seen.operator_touches = prediction.force_base.norm() > 0.0;
  const Eigen::Vector3d& direction = object.monitor().direction_base();
  seen.robot_force = seen.robot_touches ? sample.force_base.dot(direction) : 0.0;
  seen.operator_force =
      seen.robot_touches ? prediction.force_base.dot(direction) : prediction.force_base.norm();
  if (!has_force(now_)) seen.robot_touches = seen.operator_touches = false;
  if (estimate.is_current) seen.position_gap = gap;
  seen.push_gap =
      (here.x - prediction.pose.x) * direction.x() + (here.y - prediction.pose.y) * direction.y();
  seen.position_std = estimate.std;
  if (object.corrections().is_full_state_due()) {
    send_full_state(index, sample, prediction.pose, seen);
    return;
  }
  const double allowed =
      options_.correction_switch.burst_bytes +
      options_.correction_switch.byte_budget * static_cast<double>(streaming_bytes_);
  if (pending_trial_ && pending_trial_->object() == index) {
    if (pending_trial_->is_due(sample.t)) send_tried(sample);
    return;
  }
  std::optional<CorrectionCase> which =
      object.corrections().decision().evaluate(seen, static_cast<double>(sent_bytes_) / allowed);
  if (is_release_due(object, sample.t)) return send_release(index, sample.t);
  if (pending_trial_) return;  // of another object
  if (!which) which = take_unfinished_law(object, seen);
  if (!which) return;
  const bool is_learned_lately = object.knowledge().was_planned_within(sample.t, kLearnAgain);
  // A slide is identified at its own intervals: its force alone is no reason for more.
  const bool is_by_force = object.corrections().decision().is_sliding_force();
  if (!is_learned_lately && !object.knowledge().has_identification() &&
      object.monitor().is_touched() && !is_by_force) {
    const std::optional<double> planned = object.knowledge().planned();
    learn(object, sample.t);
    if (planned) object.knowledge().plan_no_later_than(*planned);
  }
  if (object.knowledge().has_identification() && !is_by_force)
    return;  // it is composed with what that finds
  CorrectionMessage message = compose(index, *which, sample, prediction.pose, gap, seen);
  CorrectionProposal proposal = propose(message, gap);
  if (proposal.is_empty()) return send(std::move(message), sample);
  pending_trial_.emplace(background_, sample.t, trial_, std::move(message), std::move(proposal));
}

void RobotSite::send_tried(const TouchSample& sample) {
  Expected<CorrectionMessage> message = pending_trial_->take();
  pending_trial_.reset();
  if (!message) return note_failure(PendingTrial::kTask, message.error());
  send(*std::move(message), sample);
}

std::optional<CorrectionCase> RobotSite::take_unfinished_law(RobotObject& object,
                                                             const SiteComparison& seen) {
  const bool is_touched = object.monitor().is_touched() || seen.operator_touches;
  if (is_touched || object.corrections().in_flight() || object.knowledge().is_identifying())
    return std::nullopt;
  return object.corrections().take_unfinished_law();
}

bool RobotSite::is_release_due(const RobotObject& object, double t) {
  const std::optional<double> off_since = object.corrections().off_since();
  if (!off_since) return false;
  const bool is_identified = !object.monitor().is_touched() && !object.knowledge().is_identifying();
  return is_identified || t - *off_since > kMaxKeptOff;
}

void RobotSite::send_release(std::size_t index, double t) {
  RobotObject& object = objects_[index];
  object.corrections().release();
  CorrectionMessage message;
  message.t = t;
  message.object = index;
  message.which = CorrectionCase::phases_differ;
  message.tool_retraction = Eigen::Vector3d::Zero();
  message.parameters = object.parameters();
  object.corrections().number(message, now_);
  outgoing_.push_back(std::move(message));
}

CorrectionProposal RobotSite::propose(const CorrectionMessage& message, double gap) const {
  const RobotObject& object = objects_[message.object];
  CorrectionProposal proposal;
  if (message.pose && object.pose().is_pushed() && slides(object.monitor().phase())) {
    proposal.pose = tried_pose(message);
    proposal.pose_error = gap;
  }
  proposal.contacts = tried_contacts(message.object, message.parameters);
  return proposal;
}

TriedCorrection RobotSite::tried_pose(const CorrectionMessage& message) const {
  const RobotObject& object = objects_[message.object];
  TriedCorrection tried;
  tried.t = message.t;
  tried.until = now_ + PendingTrial::kDuration + round_trip_;
  tried.object = message.object;
  for (const RobotObject& other : objects_) {
    tried.poses.push_back(planar_pose_of(other.pose().T_base_object()));
  }
  tried.poses[message.object] = *message.pose;
  tried.twist = message.twist.value_or(Eigen::Vector3d::Zero());
  tried.physics = object.physics();
  tried.lateral_base = Eigen::Vector3d::UnitZ().cross(object.monitor().direction_base());
  tried.position_std = object.pose().latest().position_std / std::sqrt(3.0);
  tried.rotation_std = object.pose().latest().rotation_std;
  tried.p_base_tip = [path = TriedPath(tip_, message.t, tip_.t().back())](double t) {
    return path.at(t);
  };
  return tried;
}

double RobotSite::resting_noise(const RobotObject& object, const TouchSample& sample,
                                const SiteComparison& seen) const {
  if (!seen.operator_slides) return kRestStds * seen.position_std;
  // A slide is noticed here after it began: up to what is no slide yet, and the tip's path since
  // the latest frame, the operator's site may be ahead and right.
  return options_.phases.slow_slide_displacement +
         (sample.p_base_tip - tip_.at(object.pose().latest().t)).norm();
}

std::vector<TriedContact> RobotSite::tried_contacts(std::size_t index,
                                                    const ObjectParameters& parameters) const {
  std::vector<TriedContact> contacts;
  const RobotObject& object = objects_[index];
  if (is_empty(parameters) || object.is_shared() || !has_force(now_)) return contacts;
  ObjectParameters next = object.corrections().acknowledged();
  overwrite(next, parameters);
  const BodyPhysics before = object.physics_with(object.corrections().acknowledged());
  const BodyPhysics after = object.physics_with(next);
  const double smoothing = std::max(kTipSmoothing, kMinSmoothedIntervals * tip_.interval());
  for (const Contact& tracked : object.pose().tracked_contacts()) {
    const double end = std::min(tracked.begin + ObjectPose::kMaxTrackedTime, processed_);
    if (tracked.begin < tip_.t().front() || tracked.tracked.empty()) continue;
    TriedContact& tried = contacts.emplace_back();
    tried.contact = tracked;
    tried.contact.object = index;
    tried.contact.end = end;
    const ForceStream::Record force = force_.between(tracked.begin, end);
    tried.contact.t.assign(force.t.begin(), force.t.end());
    for (const Eigen::Vector3d& clean : force.clean_base) {
      tried.contact.force.push_back((clean - bias_base_).dot(tracked.direction_base));
    }
    tried.force_resolution = sensors_.enter_force;
    const TriedPath path(tip_, tracked.begin - smoothing, end + smoothing);
    tried.p_base_tip = [smoothing, path](double t) { return path.smooth_at(t, smoothing); };
    tried.before = before;
    tried.after = after;
    // The surface is measured on the face that is touched now: another one's need not change.
    const bool is_newest = &tracked == &object.pose().tracked_contacts().back();
    if (!is_newest) tried.after.surface_offset = before.surface_offset;
  }
  return contacts;
}

void RobotSite::send_full_state(std::size_t index, const TouchSample& sample,
                                const PlanarPose& predicted, const SiteComparison& seen) {
  RobotObject& object = objects_[index];
  if (!seen.position_gap) return;
  object.corrections().note_full_state();
  CorrectionMessage message;
  message.t = sample.t;
  message.object = index;
  message.pose = planar_pose_of(object.estimate_pose(sample, predicted).T_base_object);
  message.twist = object.pose().twist();
  message.parameters = object.parameters();
  object.corrections().number(message, now_);
  outgoing_.push_back(std::move(message));
}

CorrectionMessage RobotSite::compose(std::size_t index, CorrectionCase which,
                                     const TouchSample& sample, const PlanarPose& predicted,
                                     double gap, const SiteComparison& seen) {
  RobotObject& object = objects_[index];
  const bool is_pose_current = seen.position_gap && gap > options_.messages.min_pose_error &&
                               !object.corrections().decision().is_sliding_force();
  const bool is_noise = !seen.robot_slides && gap < resting_noise(object, sample, seen);
  const ParameterDifference changed =
      difference(object.parameters(), object.corrections().acknowledged(),
                 object.corrections().in_flight(), options_.messages);
  CorrectionMessage message;
  message.t = sample.t;
  message.object = index;
  message.which = which;
  if (is_pose_current && !is_noise) {
    // Again, since newly identified contact parameters change it.
    message.pose = planar_pose_of(object.estimate_pose(sample, predicted).T_base_object);
    if (seen.operator_slides || slides(object.monitor().phase()))
      message.twist = object.pose().twist();
  }
  message.parameters = parameters_to_send(
      changed, which, object.corrections().decision().forces_agree(seen), options_.messages);
  return message;
}

void RobotSite::send(CorrectionMessage message, const TouchSample& sample) {
  RobotObject& object = objects_[message.object];
  const CorrectionCase which = message.which;
  const bool has_parameters = !is_empty(message.parameters);
  const bool is_known = !message.pose && !has_parameters;
  const bool is_unfinished =
      message.parameters.contact_stiffness || !contact_law_of(object.knowledge().parameters());
  if (is_unfinished && object.monitor().is_touched())
    object.corrections().note_unfinished_law(which);
  if (is_known || (!has_parameters && object.corrections().decision().had_no_effect(which))) {
    return object.corrections().decision().note_nothing_to_send(which, sample.t);
  }
  const double inside = std::max(-object.pose().touch(sample.p_base_tip).gap, 0.0);
  if (which == CorrectionCase::touched_by_robot && message.pose) {
    message.tool_retraction = -inside * object.monitor().direction_base();
  }
  if (options_.correction_switch.keeps_off && which == CorrectionCase::phases_differ &&
      has_parameters && object.pose().is_pushed() && !object.corrections().off_since()) {
    message.tool_retraction = -(inside + kOffDistance) * object.monitor().direction_base();
    object.corrections().keep_off(sample.t);
  }
  object.corrections().number(message, now_);
  outgoing_.push_back(std::move(message));
}

}  // namespace pcavr
