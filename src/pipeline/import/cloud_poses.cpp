// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "cloud_poses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {
namespace {

/// Stamps in names and in a list of poses may be rounded differently [ns].
constexpr std::int64_t kStampRounding = 1'000'000;

/// The pose of Trajectory::at, or the pose at the same stamp but for rounding.
std::optional<Pose> pose_at(const Trajectory& trajectory, Stamp stamp) {
  if (const std::optional<Pose> pose = trajectory.at(stamp)) return pose;
  const std::vector<TimedPose>& poses = trajectory.poses();
  const auto next = std::lower_bound(
      poses.begin(), poses.end(), stamp.nanoseconds - kStampRounding,
      [](const TimedPose& pose, std::int64_t at) { return pose.stamp.nanoseconds < at; });
  if (next == poses.end() || next->stamp.nanoseconds > stamp.nanoseconds + kStampRounding) {
    return std::nullopt;
  }
  return next->pose;
}

/// The rotation nearest to all [Markley et al. 2007, eq. 12, with equal weights].
Eigen::Quaterniond mean_rotation(const std::vector<Pose>& poses) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const Pose& pose : poses) {
    const Eigen::Vector4d q = pose.rotation().coeffs();
    sum += q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(sum);
  return Eigen::Quaterniond(Eigen::Vector4d(solver.eigenvectors().col(3)));
}

/// A camera's pose by tags in base, and by poses in the world.
struct PosePair {
  Pose T_base_camera;
  Pose T_world_camera;
};

Pose fit_base_world(const std::vector<PosePair>& pairs) {
  std::vector<Pose> each;
  for (const PosePair& pair : pairs) {
    each.push_back(pair.T_base_camera * pair.T_world_camera.inverse());
  }
  const Eigen::Quaterniond rotation = mean_rotation(each);
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    translation += pair.T_base_camera.translation() - rotation * pair.T_world_camera.translation();
  }
  return Pose(rotation, translation / static_cast<double>(pairs.size()));
}

}  // namespace

Expected<std::vector<Pose>> read_cloud_poses(const std::filesystem::path& file,
                                             const CloudList& list,
                                             const std::vector<std::size_t>& selected) {
  const Expected<Trajectory> trajectory = read_trajectory(file);
  if (!trajectory) return trajectory.error();
  std::vector<Pose> by_time;
  for (const std::size_t i : selected) {
    const std::optional<Pose> pose = pose_at(*trajectory, list.clouds[i].stamp);
    if (!pose) break;
    by_time.push_back(*pose);
  }
  if (by_time.size() == selected.size()) return by_time;
  if (trajectory->size() == list.clouds.size() && (by_time.empty() || !list.has_times)) {
    std::vector<Pose> by_order;
    for (const std::size_t i : selected) by_order.push_back(trajectory->poses()[i].pose);
    return by_order;
  }
  const ListedCloud& unmatched = list.clouds[selected[by_time.size()]];
  return Error{
      .message = std::to_string(trajectory->size()) + " poses for " +
                 std::to_string(list.clouds.size()) + " clouds, and none at the stamp of " +
                 unmatched.file.filename().string() + ", " + format_stamp(unmatched.stamp) + " s",
      .file = file.string(),
      .hint = "write a pose at the stamp of each cloud, or one for each in their order"};
}

Expected<TagAnchorCollector> TagAnchorCollector::create(const Manifest& manifest,
                                                        const CameraModel& camera) {
  std::vector<TagPlacement> placements = base_placements(manifest);
  std::set<std::string> families;
  for (const TagPlacement& placement : placements) families.insert(placement.id.family);
  Expected<TagDetector> detector = TagDetector::create({families.begin(), families.end()});
  if (!detector) return detector.error();
  return TagAnchorCollector(*std::move(detector), std::move(placements), camera);
}

void TagAnchorCollector::add(std::size_t frame, const ColorImage& color, const DepthImage& depth) {
  const BodyPose base =
      solve_body_pose(placements_, detector_.detect(to_gray(color)), camera_, {.depth = &depth});
  if (base.status != BodyPoseStatus::solved) return;
  observations_.push_back({frame, base.pose.T_camera_body.inverse()});
}

std::optional<TagAnchor> TagAnchorCollector::solve(const std::vector<Pose>& T_world_camera) const {
  std::vector<PosePair> pairs;
  for (const Observation& seen : observations_) {
    pairs.push_back({seen.T_base_camera, T_world_camera[seen.frame]});
  }
  if (pairs.empty()) return std::nullopt;
  Pose T_base_world = fit_base_world(pairs);
  const auto distance = [&](const PosePair& pair) {
    return translation_distance(T_base_world * pair.T_world_camera, pair.T_base_camera);
  };
  std::vector<double> distances;
  for (const PosePair& pair : pairs) distances.push_back(distance(pair));
  const double limit = 3.0 * median(std::move(distances)) + 1e-6;
  std::erase_if(pairs, [&](const PosePair& pair) { return distance(pair) > limit; });
  T_base_world = fit_base_world(pairs);
  TagAnchor anchor{.T_base_world = T_base_world, .frames = pairs.size()};
  for (const PosePair& pair : pairs) {
    const double angle = rotation_distance(T_base_world * pair.T_world_camera, pair.T_base_camera);
    anchor.position_rms += distance(pair) * distance(pair);
    anchor.rotation_rms += angle * angle;
  }
  const auto count = static_cast<double>(pairs.size());
  anchor.position_rms = std::sqrt(anchor.position_rms / count);
  anchor.rotation_rms = std::sqrt(anchor.rotation_rms / count);
  return anchor;
}

}  // namespace pcavr
