// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "cloud_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <utility>

#include <Eigen/Eigenvalues>

#include "pcavr/cloud/cloud_alignment.hpp"
#include "pcavr/core/median.hpp"
#include "pcavr/recording/recording.hpp"

namespace pcavr {
namespace {

/// Overlap of neighbouring clouds by the poses as given that needs no explanation.
constexpr double kPlausibleOverlap = 0.6;
/// Below it, poses that no hypothesis explains are doubtful: a sequence shows the same place again.
constexpr double kDoubtfulOverlap = 0.3;
/// A hypothesis explains the clouds where they overlap by this much more.
constexpr double kExplainedOverlap = 0.2;
constexpr std::size_t kComparedPairs = 8;

Pose mirrored(const Pose& pose, int axis) {
  Eigen::Matrix4d S = Eigen::Matrix4d::Identity();
  S(axis, axis) = -1.0;
  return Pose::from_matrix(S * pose.matrix() * S);
}

struct PoseHypothesis {
  const char* name;
  const char* hint;
  std::function<Pose(const Pose&)> pose;
};

const std::array<PoseHypothesis, 5>& pose_hypotheses() {
  static const std::array<PoseHypothesis, 5> hypotheses{
      {{"inverted", "write the pose of the cloud's frame in the world, T_world_cloud",
        [](const Pose& pose) { return pose.inverse(); }},
       {"in millimetres", "write positions in metres",
        [](const Pose& pose) { return Pose(pose.rotation(), pose.translation() * 1e-3); }},
       {"of a left-handed frame, mirrored along x", "write poses of right-handed frames",
        [](const Pose& pose) { return mirrored(pose, 0); }},
       {"of a left-handed frame, mirrored along y", "write poses of right-handed frames",
        [](const Pose& pose) { return mirrored(pose, 1); }},
       {"of a left-handed frame, mirrored along z", "write poses of right-handed frames",
        [](const Pose& pose) { return mirrored(pose, 2); }}}};
  return hypotheses;
}

/// Mean overlap of pairs of clouds along the sequence, with each pose passed through `change`.
double mean_overlap(const std::vector<Pose>& T_world_cloud,
                    const std::vector<std::vector<Eigen::Vector3f>>& clouds, double voxel,
                    Parallelism parallelism, const std::function<Pose(const Pose&)>& change) {
  const std::size_t step = compared_cloud_step(clouds.size());
  std::vector<double> overlaps((clouds.size() - 1) / step);
  if (overlaps.empty()) return 1.0;
  parallel_for(parallelism, overlaps.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pair = begin; pair < end; ++pair) {
      const std::size_t a = pair * step;
      const std::size_t b = a + step;
      const Pose T_a_b = change(T_world_cloud[a]).inverse() * change(T_world_cloud[b]);
      overlaps[pair] = compare_clouds(clouds[a], clouds[b], T_a_b, voxel).overlap;
    }
  });
  return std::accumulate(overlaps.begin(), overlaps.end(), 0.0) /
         static_cast<double>(overlaps.size());
}

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

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

std::size_t compared_cloud_step(std::size_t clouds) {
  return std::max<std::size_t>(1, clouds / (kComparedPairs + 1));
}

Expected<std::vector<Pose>> read_cloud_poses(const std::filesystem::path& file,
                                             const CloudList& list,
                                             const std::vector<std::size_t>& selected) {
  const Expected<Trajectory> trajectory = read_trajectory(file);
  if (!trajectory) return trajectory.error();
  std::vector<Pose> by_time;
  for (const std::size_t i : selected) {
    const std::optional<Pose> pose = trajectory->at(list.clouds[i].stamp);
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

Expected<void> check_cloud_poses(const std::vector<Pose>& T_world_cloud,
                                 const std::vector<std::vector<Eigen::Vector3f>>& thinned_clouds,
                                 double voxel, const std::filesystem::path& file,
                                 Parallelism parallelism, const Observer& observer) {
  const auto overlap_by = [&](const std::function<Pose(const Pose&)>& change) {
    return mean_overlap(T_world_cloud, thinned_clouds, voxel, parallelism, change);
  };
  const double given = overlap_by([](const Pose& pose) { return pose; });
  if (given >= kPlausibleOverlap) return {};
  const PoseHypothesis* best = nullptr;
  double best_overlap = given + kExplainedOverlap;
  for (const PoseHypothesis& hypothesis : pose_hypotheses()) {
    const double overlap = overlap_by(hypothesis.pose);
    if (overlap < best_overlap) continue;
    best = &hypothesis;
    best_overlap = overlap;
  }
  if (best == nullptr) {
    if (given < kDoubtfulOverlap) {
      observer.on_warning(file.string() +
                          ": by these poses, clouds that follow each other overlap by " +
                          percent(given) + " only; if they show one place, check the poses");
    }
    return {};
  }
  return Error{.message = std::string("the poses are ") + best->name +
                          ": as given, clouds that follow each other overlap by " + percent(given) +
                          ", else by " + percent(best_overlap),
               .file = file.string(),
               .hint = best->hint};
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
