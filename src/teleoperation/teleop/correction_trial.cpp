// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/correction_trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcavr {
namespace {

/// Step of a trial over the predictor's step: a trial needs the error to some per cent only, and
/// takes the site's time.
constexpr double kStepFactor = 2.0;
/// Longest prediction [s]: beyond it every push is unstable.
constexpr double kMaxTrial = 1.0;
// [stds] of a correction as it is displayed, above which it is worse than an error of that size.
// Three would also hold back corrections that help slow pushes.
constexpr double kGrowthStds = 1.0;
// Parameters are sent unless the prediction of a contact grows worse by this factor: its error has
// other causes too.
constexpr double kMaxErrorRatio = 1.5;

class RootMeanSquare {
 public:
  void add(double value) {
    sum_ += value * value;
    ++count_;
  }
  [[nodiscard]] double value() const {
    return count_ > 0 ? std::sqrt(sum_ / static_cast<double>(count_)) : 0.0;
  }

 private:
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

}  // namespace

CorrectionTrial::CorrectionTrial(const TeleopInput& world, const std::vector<BodyPhysics>& physics,
                                 const TeleopOptions& options)
    : rotation_radius_(options.messages.rotation_radius),
      position_stds_(options.correction_switch.position_stds),
      min_position_error_(options.correction_switch.min_position_error),
      force_tolerance_(options.correction_switch.force_tolerance),
      step_(kStepFactor * options.predictor.step) {
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

TrialResult CorrectionTrial::evaluate(const CorrectionProposal& proposal) {
  TrialResult result;
  if (proposal.pose) {
    const std::optional<double> displayed = displayed_std(*proposal.pose);
    result.rejects_pose = displayed && kGrowthStds * *displayed > proposal.pose_error;
  }
  for (const TriedContact& tried : proposal.contacts) {
    const std::optional<double> error = error_of(tried, tried.after);
    // One that can't be noticed is right whatever the error was: a trial less.
    if (!error || *error <= 1.0) continue;
    if (*error <= kMaxErrorRatio * *error_of(tried, tried.before)) continue;
    result.rejects_parameters = true;
    break;
  }
  return result;
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

std::optional<double> CorrectionTrial::error_of(const TriedContact& tried,
                                                const BodyPhysics& physics) {
  const Contact& contact = tried.contact;
  if (!world_ || !contact.object || contact.tracked.empty()) return std::nullopt;
  const std::size_t object = *contact.object;
  std::vector<BodyState> alone = untouched_;
  for (std::size_t i = 0; i < alone.size(); ++i) alone[i].is_present = i == object;
  world_->set_state(alone);
  world_->set_physics(object, physics);
  world_->set_pose(object, contact.T_base_object);
  RootMeanSquare position, force, measured_force, seen_std;
  auto seen = contact.tracked.begin();
  std::size_t next_force = 0;
  Eigen::Vector3d before = tried.p_base_tip(contact.begin);
  const auto steps = static_cast<int>(std::lround((contact.end - contact.begin) / step_));
  for (int k = 1; k <= steps; ++k) {
    const double t = contact.begin + step_ * k;
    const Eigen::Vector3d after = tried.p_base_tip(t);
    world_->step(before, after, step_);
    before = after;
    for (; seen != contact.tracked.end() && seen->t <= t; ++seen) {
      const Pose predicted = world_->T_base_object(object);
      position.add((predicted.translation() - seen->T_base_object.translation())
                       .dot(contact.direction_base));
      seen_std.add(seen->position_std / std::sqrt(3.0));
    }
    const double predicted = world_->state()[object].tool_force_base.dot(contact.direction_base);
    for (; next_force < contact.t.size() && contact.t[next_force] <= t; ++next_force) {
      force.add(predicted - contact.force[next_force]);
      measured_force.add(contact.force[next_force]);
    }
  }
  const double noticed = std::max(position_stds_ * seen_std.value(), min_position_error_);
  const double felt = std::max(force_tolerance_ * measured_force.value(), tried.force_resolution);
  return std::hypot(position.value() / noticed, force.value() / felt);
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
