// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/pose_outliers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

/// Largest acceleration of a body that is pushed there and back [m/s^2]: friction does not bring it
/// back faster.
constexpr double kMaxAcceleration = 10.0;
constexpr double kLever = 0.1;  // [m] by which rotations have the same bounds
// Bounds for a body that is pushed or carried.
constexpr double kMaxSpeed = 1.0;   // [m/s]
constexpr double kNoiseStds = 6.0;  // of both poses together
// Smaller steps do no harm, and trackers round.
constexpr double kMinPositionStep = 5e-4;  // [m]
constexpr double kMinRotationStep = 5e-3;  // [rad]
constexpr double kMinStay = 0.25;          // [s] after a jump that no push explains
// Poses at an end of a series that may be outliers, and poses without which nothing shows.
constexpr std::size_t kMaxEndOutliers = 3;
constexpr std::size_t kMinSeries = 6;
constexpr std::size_t kEnd = 12;  // poses that show which of the first ones are outliers

/// A motion between two poses: in translation, and as a rotation vector in the axes of the first.
struct Motion {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();     ///< [m]
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad]
};

Motion motion_between(const TrackedPose& a, const TrackedPose& b) {
  const Pose &from = a.T_base_object, &to = b.T_base_object;
  const Eigen::AngleAxisd rotation(from.rotation().conjugate() * to.rotation());
  return {to.translation() - from.translation(), rotation.angle() * rotation.axis()};
}

/// Distance of a point to the straight line from the origin to `end`.
double distance_to_line(const Eigen::Vector3d& point, const Eigen::Vector3d& end) {
  const double square = end.squaredNorm();
  const double share = square > 0.0 ? std::clamp(point.dot(end) / square, 0.0, 1.0) : 0.0;
  return (point - share * end).norm();
}

/// Whether `pose` is farther from all poses on the way along `path` from `start` than noise, or a
/// motion of `reach` [m], explains.
bool is_off(const TrackedPose& start, const Motion& path, const TrackedPose& pose, double reach) {
  const Motion motion = motion_between(start, pose);
  const double position_noise = kNoiseStds * std::hypot(start.position_std, pose.position_std);
  const double rotation_noise = kNoiseStds * std::hypot(start.rotation_std, pose.rotation_std);
  return distance_to_line(motion.shift, path.shift) >
             std::max({position_noise, reach, kMinPositionStep}) ||
         distance_to_line(motion.rotation, path.rotation) >
             std::max({rotation_noise, reach / kLever, kMinRotationStep});
}

/// Whether a body that is at `before` and at `after` was not at `pose` between.
bool is_excursion(const TrackedPose& before, const TrackedPose& pose, const TrackedPose& after) {
  const double reach = 0.5 * kMaxAcceleration * (pose.t - before.t) * (after.t - pose.t);
  return is_off(before, motion_between(before, after), pose, reach);
}

/// Median deviation of a pose from those around it: about its std, whatever a tracker states.
void raise_noise(std::vector<TrackedPose>& poses) {
  std::vector<double> positions, rotations;
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    const TrackedPose &before = poses[i - 1], &after = poses[i + 1];
    const double share = (poses[i].t - before.t) / (after.t - before.t);
    const Pose between = interpolate(before.T_base_object, after.T_base_object, share);
    positions.push_back(translation_distance(between, poses[i].T_base_object));
    rotations.push_back(rotation_distance(between, poses[i].T_base_object));
  }
  const double position_std = median(std::move(positions));
  const double rotation_std = median(std::move(rotations));
  for (TrackedPose& pose : poses) {
    pose.position_std = std::max(pose.position_std, position_std);
    pose.rotation_std = std::max(pose.rotation_std, rotation_std);
  }
}

void append_stamps(const std::vector<TrackedPose>& poses, std::vector<double>& stamps) {
  for (const TrackedPose& pose : poses) stamps.push_back(pose.t);
}

/// Stamps of the poses that are accepted.
std::vector<double> accepted_stamps(std::span<const TrackedPose> poses) {
  PoseOutlierFilter filter(PoseSource::file);
  std::vector<double> stamps;
  for (const TrackedPose& pose : poses) append_stamps(filter.add(pose), stamps);
  append_stamps(filter.finish(), stamps);
  return stamps;
}

void keep(const std::vector<double>& stamps, std::vector<TrackedPose>& poses) {
  std::erase_if(poses, [&](const TrackedPose& pose) {
    return !std::binary_search(stamps.begin(), stamps.end(), pose.t);
  });
}

/// The first poses, too, are accepted where later ones confirm them.
void keep_confirmed_first(std::vector<TrackedPose>& poses) {
  const std::size_t count = std::min(kEnd, poses.size());
  std::vector<TrackedPose> backward(poses.begin(), poses.begin() + static_cast<int>(count));
  std::reverse(backward.begin(), backward.end());
  for (TrackedPose& pose : backward) pose.t = -pose.t;
  const double first = -accepted_stamps(backward).back();
  std::erase_if(poses, [first](const TrackedPose& pose) { return pose.t < first; });
}

}  // namespace

bool PoseOutlierFilter::is_near(const std::optional<TrackedPose>& before, const TrackedPose& last,
                                const TrackedPose& pose) const {
  const double duration = pose.t - last.t;
  // A file's poses may wait, so that all are compared with those around them.
  const double acceleration = (source_ == PoseSource::file ? 0.5 : 1.0) * kMaxAcceleration;
  const double reach = std::min(acceleration * duration, kMaxSpeed) * duration;
  if (!before) return !is_off(last, {}, pose, reach);
  Motion path = motion_between(*before, last);
  const double factor = duration / (last.t - before->t);
  path.shift *= factor;
  path.rotation *= factor;
  return !is_off(last, path, pose, reach);
}

bool PoseOutlierFilter::has_stayed(double t) const {
  const TrackedPose& first = waiting_[stay_];
  if (t - first.t >= kMinStay) return true;
  return source_ == PoseSource::stream &&
         !is_off(*last_, {}, first, kMaxSpeed * (first.t - last_->t));
}

void PoseOutlierFilter::accept(const TrackedPose& pose, std::vector<TrackedPose>& accepted) {
  before_ = std::exchange(last_, pose);
  accepted.push_back(pose);
}

/// Those that waited, without the outliers among them: where the body is at `returned` again, all
/// that it can't have been at between; where it has stayed elsewhere, those before that.
std::vector<TrackedPose> PoseOutlierFilter::take_waiting(const TrackedPose* returned) {
  std::vector<TrackedPose> accepted;
  const std::optional<TrackedPose> last = last_;
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    const TrackedPose& pose = waiting_[i];
    if (returned == nullptr ? i >= stay_ : !is_excursion(*last, pose, *returned)) {
      accept(pose, accepted);
    } else if (outliers_.count++ == 0) {
      outliers_.first = pose.t;
    }
  }
  waiting_.clear();
  stay_ = 0;
  return accepted;
}

std::vector<TrackedPose> PoseOutlierFilter::add(const TrackedPose& pose) {
  const bool has_returned = !last_ || is_near(before_, *last_, pose);
  if (!has_returned) {
    const std::size_t count = waiting_.size();
    const std::optional<TrackedPose> before = count > stay_ + 1 ? waiting_[count - 2] : last_;
    if (count == 0 || !is_near(before, waiting_.back(), pose)) stay_ = count;
    if (stay_ == count || !has_stayed(pose.t)) {
      waiting_.push_back(pose);
      return {};
    }
  }
  std::vector<TrackedPose> accepted = take_waiting(has_returned ? &pose : nullptr);
  accept(pose, accepted);
  return accepted;
}

std::vector<TrackedPose> PoseOutlierFilter::finish() {
  if (waiting_.size() - stay_ <= kMaxEndOutliers) stay_ = waiting_.size();
  return take_waiting(nullptr);
}

PoseOutliers remove_pose_outliers(std::vector<TrackedPose>& poses) {
  if (poses.size() < kMinSeries) return {};
  std::vector<TrackedPose> checked = poses;
  raise_noise(checked);
  keep(accepted_stamps(checked), checked);
  keep_confirmed_first(checked);
  std::vector<double> kept;
  append_stamps(checked, kept);
  const auto first = std::mismatch(kept.begin(), kept.end(), poses.begin(), poses.end(),
                                   [](double t, const TrackedPose& pose) { return t == pose.t; });
  PoseOutliers found{poses.size() - kept.size()};
  if (found.count > 0) found.first = first.second->t;
  keep(kept, poses);
  return found;
}

std::string describe(const PoseOutliers& outliers) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "the pose jumps and returns, first at t = %.6f s",
                outliers.first);
  return text.data();
}

}  // namespace pcavr
