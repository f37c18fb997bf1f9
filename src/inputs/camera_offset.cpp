// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "inputs/clock_offsets.hpp"

namespace pcavr {
namespace {

constexpr double kMaxLever = 0.010;  // [m]: with a larger lever arm, a push rotates the object
constexpr double kRestBefore = 0.2;  // [s] included: a slide at constant speed alone fits any delay
constexpr double kSpeedStep = 0.02;  // [s] of the central difference for the speed
constexpr double kMaxOffset = 0.25;  // [s] as for the force
constexpr double kMaxOffsetStep = 0.05;
constexpr int kIterations = 8;
constexpr double kMinPoses = 8.0;

constexpr double kMinPushDisplacement = 0.005;  // [m] of displacement that is certainly a push
// Free time kept around a motion, and the offset's range [s].
constexpr double kAroundMotion = 1.0;
constexpr double kMotionRange = 0.2;
// [s] by a path that turns with the object, and by the contact's compression.
constexpr double kMotionBias = 0.005;
constexpr double kMinMotionSpeed = 0.1;  // [m/s] between frames: certainly in motion

/// Sums of a linear least-squares fit of the residual on the speed, about each contact's means: one
/// Gauss-Newton step of the offset.
struct Sums {
  double speed_squares = 0.0;     ///< [m^2/s^2]
  double gradient = 0.0;          ///< [m^2/s]
  double residual_squares = 0.0;  ///< [m^2]
  double count = 0.0;

  void add(const ContactEpisode& episode, std::span<const TrackedPose> tracked, double offset) {
    std::vector<double> residual, speed;
    for (const TrackedPose& pose : tracked) {
      if (pose.t < episode.begin - kRestBefore || pose.t > episode.end) continue;
      const double at = pose.t - offset;
      residual.push_back(pose.T_base_object.translation().dot(episode.direction_base) -
                         displacement_at(episode, at));
      speed.push_back(
          (displacement_at(episode, at + kSpeedStep) - displacement_at(episode, at - kSpeedStep)) /
          (2.0 * kSpeedStep));
    }
    if (residual.size() < 4) return;
    const auto n = static_cast<double>(residual.size());
    double mean = 0.0, mean_speed = 0.0;
    for (std::size_t i = 0; i < residual.size(); ++i) {
      mean += residual[i] / n;
      mean_speed += speed[i] / n;
    }
    for (std::size_t i = 0; i < residual.size(); ++i) {
      speed_squares += std::pow(speed[i] - mean_speed, 2);
      gradient -= (speed[i] - mean_speed) * (residual[i] - mean);
      residual_squares += std::pow(residual[i] - mean, 2);
    }
    count += n;
  }
};

/// The frames of an object's longest uninterrupted motion.
struct Motion {
  std::size_t begin = 0;
  std::size_t end = 0;
  double length = 0.0;  ///< [m] of the path
};
Motion longest_motion(std::span<const TrackedPose> tracked) {
  Motion longest;
  Motion now;
  for (std::size_t i = 1; i < tracked.size(); ++i) {
    const double step =
        (tracked[i].T_base_object.translation() - tracked[i - 1].T_base_object.translation())
            .head<2>()
            .norm();
    const double duration = tracked[i].t - tracked[i - 1].t;
    if (step < std::min(3.0 * tracked[i].position_std, kMinMotionSpeed * duration)) {
      now = {i, i, 0.0};
      continue;
    }
    now.end = i;
    now.length += step;
    if (now.length > longest.length) longest = now;
  }
  return longest;
}

Eigen::Vector3d mean_position(std::span<const TrackedPose> tracked, const Eigen::Vector3d& p_object,
                              double from, double to) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const TrackedPose& pose : tracked) {
    if (pose.t < from || pose.t > to) continue;
    sum += pose.T_base_object * p_object;
    count += 1.0;
  }
  return count > 0.0 ? Eigen::Vector3d(sum / count)
                     : Eigen::Vector3d(tracked.front().T_base_object * p_object);
}

}  // namespace

TimeOffset camera_offset(const InputSeries& series, std::span<const AttributedContact> contacts) {
  TimeOffset result;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Sums sums;
    for (const AttributedContact& contact : contacts) {
      const bool is_usable = contact.object && contact.left_out.empty() &&
                             !contact.episode.slides.empty() &&
                             std::abs(contact.lever) <= kMaxLever;
      if (is_usable)
        sums.add(contact.episode, series.bodies[*contact.object].tracked, result.offset);
    }
    if (sums.count < kMinPoses || sums.speed_squares <= 0.0) return result;
    result.offset +=
        std::clamp(sums.gradient / sums.speed_squares, -kMaxOffsetStep, kMaxOffsetStep);
    result.std = std::sqrt(sums.residual_squares / sums.count / sums.speed_squares);
    result.std = std::hypot(result.std, kMotionBias);
    result.is_known = std::abs(result.offset) < kMaxOffset && result.std < 0.1 * kMaxOffset;
  }
  return result;
}

TimeOffset motion_offset(const InputBody& body, const PathView& tip,
                         std::span<const Eigen::Vector3d> p_base_tip) {
  const std::span<const TrackedPose> tracked = body.tracked;
  if (tracked.size() < 10) return {};
  const Motion motion = longest_motion(tracked);
  if (motion.length < kMinPushDisplacement) return {};
  // The slow start and end of a motion are below the noise.
  const double begin = tracked[motion.begin].t - kAroundMotion;
  const double end = tracked[motion.end].t + kAroundMotion;
  // Of the point that is pushed: an object that turns takes its other points along faster or
  // slower.
  const TrackedPose& first = tracked[motion.begin];
  const Eigen::Vector3d p_object = first.T_base_object.inverse() * tip.at(first.t);
  const Eigen::Vector3d from =
      mean_position(tracked, p_object, begin, begin + kAroundMotion - kMotionRange);
  const Eigen::Vector3d displacement =
      mean_position(tracked, p_object, end - kAroundMotion + kMotionRange, end) - from;
  if (displacement.head<2>().norm() < kMinPushDisplacement) return {};
  const Eigen::Vector3d along =
      Eigen::Vector3d(displacement.x(), displacement.y(), 0.0).normalized();
  const double length = displacement.dot(along);
  // The pushed object moves with the tip: correlates its displacement with the tip's, which is
  // clipped to the same range.
  std::vector<double> t_tip, pushed, t_seen, seen;
  std::optional<double> furthest;
  for (std::size_t i = 0; i < tip.t().size(); ++i) {
    if (tip.t()[i] < begin || tip.t()[i] > end) continue;
    t_tip.push_back(tip.t()[i]);
    pushed.push_back(p_base_tip[i].dot(along));
    const bool is_moving = tip.t()[i] > begin + kAroundMotion - kMotionRange &&
                           tip.t()[i] < end - kAroundMotion + kMotionRange;
    if (is_moving) furthest = std::max(furthest.value_or(pushed.back()), pushed.back());
  }
  if (!furthest) return {};
  double reached = 0.0;
  for (double& value : pushed) {
    reached = std::max(reached, std::clamp(value - (*furthest - length), 0.0, length));
    value = reached;
  }
  for (const TrackedPose& pose : tracked) {
    if (pose.t < begin || pose.t > end) continue;
    t_seen.push_back(pose.t);
    seen.push_back((pose.T_base_object * p_object - from).dot(along));
  }
  TimeOffsetOptions options;
  options.range = kMotionRange;
  TimeOffset offset = estimate_time_offset(t_tip, pushed, t_seen, seen, options);
  if (!offset.is_known || offset.correlation < 0.9) return {};
  offset.std = std::hypot(offset.std, kMotionBias);
  return offset;
}

}  // namespace pcavr
