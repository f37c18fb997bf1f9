// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/correction_trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcavr {
namespace {

/// Longest prediction [s]: beyond it every push is unstable.
constexpr double kMaxTrial = 1.0;

double root_mean(double squares, std::size_t count) {
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

}  // namespace

CorrectionTrial::CorrectionTrial(const TeleopInput& world, const std::vector<BodyPhysics>& physics,
                                 const TeleopOptions& options)
    : rotation_radius_(options.messages.rotation_radius),
      position_stds_(options.correction_switch.position_stds),
      min_position_error_(options.correction_switch.min_position_error),
      force_tolerance_(options.correction_switch.force_tolerance),
      step_(options.predictor.step) {
  WorldModel model;
  model.tool_radius = world.tool_radius;
  model.gravity = options.gravity();
  model.options = options.world;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const TeleopObject& object = world.objects[i];
    model.bodies.push_back({object.model, object.T_base_object, physics[i], object.is_movable});
    T_base_starts_.push_back(object.T_base_object);
  }
  Expected<PredictedWorld> copy = PredictedWorld::create(std::move(model));
  if (!copy) return;
  world_ = std::move(*copy);
  untouched_ = world_->state();
}

std::optional<double> CorrectionTrial::displayed_std(const TriedCorrection& tried) {
  if (!world_) return std::nullopt;
  const Eigen::Vector3d nominal = end_of(tried, 0.0, 0.0);
  const auto distance = [&](const Eigen::Vector3d& end) {
    const Eigen::Vector3d difference = end - nominal;
    return difference.head<2>().norm() +
           rotation_radius_ * std::abs(std::remainder(difference.z(), 2.0 * M_PI));
  };
  return std::hypot(distance(end_of(tried, tried.position_std, 0.0)),
                    distance(end_of(tried, 0.0, tried.rotation_std)));
}

void CorrectionTrial::begin(ContactRun& run) {
  const RecordedContact& contact = *run.contact;
  std::vector<BodyState> alone = untouched_;
  for (std::size_t i = 0; i < alone.size(); ++i) alone[i].is_present = i == contact.object;
  world_->set_state(alone);
  world_->set_pose(contact.object, contact.T_base_start);
  run.state = world_->state();
}

bool CorrectionTrial::advance(ContactRun& run, std::size_t& steps) {
  const RecordedContact& contact = *run.contact;
  const double duration = std::max(contact.end - contact.begin, 0.0);
  const auto last = static_cast<std::size_t>(std::lround(duration / step_));
  if (run.step < last && steps == 0) return false;
  world_->set_physics(contact.object, run.physics);
  if (run.state.empty()) begin(run);
  world_->set_state(run.state);
  const auto t_of = [&](std::size_t k) { return contact.begin + step_ * static_cast<double>(k); };
  Eigen::Vector3d before = contact.p_base_tip(t_of(run.step));
  for (; run.step < last && steps > 0; --steps) {
    const double t = t_of(++run.step);
    const Eigen::Vector3d after = contact.p_base_tip(t);
    world_->step(before, after, step_);
    before = after;
    compare(run, t);
  }
  run.state = world_->state();
  return run.step >= last;
}

/// With what was measured until `t` [s].
void CorrectionTrial::compare(ContactRun& run, double t) const {
  const RecordedContact& contact = *run.contact;
  for (; run.next_seen < contact.seen.size(); ++run.next_seen) {
    const TrackedPose& seen = contact.seen[run.next_seen];
    if (seen.t > t) break;
    const Pose predicted = world_->T_base_object(contact.object);
    const double error =
        (predicted.translation() - seen.T_base_object.translation()).dot(contact.direction_base);
    run.position_squares += error * error;
  }
  const double predicted =
      world_->state()[contact.object].tool_force_base.dot(contact.direction_base);
  for (; run.next_force < contact.t_force.size(); ++run.next_force) {
    if (contact.t_force[run.next_force] > t) break;
    const double error = predicted - contact.force_base[run.next_force].dot(contact.direction_base);
    run.force_squares += error * error;
  }
}

double CorrectionTrial::error_of(const ContactRun& run) const {
  const RecordedContact& contact = *run.contact;
  double seen_squares = 0.0;
  for (std::size_t i = 0; i < run.next_seen; ++i) {
    seen_squares += contact.seen[i].position_std * contact.seen[i].position_std / 3.0;
  }
  double measured_squares = 0.0;
  for (std::size_t i = 0; i < run.next_force; ++i) {
    const double measured = contact.force_base[i].dot(contact.direction_base);
    measured_squares += measured * measured;
  }
  const double noticed =
      std::max(position_stds_ * root_mean(seen_squares, run.next_seen), min_position_error_);
  const double felt = std::max(force_tolerance_ * root_mean(measured_squares, run.next_force),
                               contact.force_resolution);
  return std::hypot(root_mean(run.position_squares, run.next_seen) / noticed,
                    root_mean(run.force_squares, run.next_force) / felt);
}

/// [x y yaw] of the object at the end of the prediction.
Eigen::Vector3d CorrectionTrial::end_of(const TriedCorrection& tried, double lateral,
                                        double rotation) {
  world_->set_state(untouched_);
  world_->set_physics(tried.object, tried.physics);
  for (std::size_t i = 0; i < tried.poses.size(); ++i) {
    PlanarPose pose = tried.poses[i];
    if (i == tried.object) {
      pose.x += lateral * tried.lateral_base.x();
      pose.y += lateral * tried.lateral_base.y();
      pose.yaw += rotation;
    }
    world_->set_pose(i, pose_at(pose, T_base_starts_[i]));
  }
  if (!tried.twist.isZero()) {
    std::vector<BodyState> state = world_->state();
    state[tried.object].planar.twist = tried.twist;
    state[tried.object].planar.phase = FrictionPhase::sliding;
    world_->set_state(state);
  }
  const double duration = std::clamp(tried.until - tried.t, 0.0, kMaxTrial);
  const auto steps = static_cast<int>(std::lround(duration / step_));
  Eigen::Vector3d before = tried.p_base_tip(tried.t);
  for (int k = 1; k <= steps; ++k) {
    const Eigen::Vector3d after = tried.p_base_tip(tried.t + step_ * k);
    world_->step(before, after, step_);
    before = after;
  }
  const PlanarPose end = planar_pose_of(world_->T_base_object(tried.object));
  return {end.x, end.y, end.yaw};
}

}  // namespace pcavr
