// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/marker/body_pose.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "pcavr/geometry/depth_grid.hpp"

#include "marker/body_pose_problem.hpp"
#include "marker/planar_pose.hpp"

namespace pcavr {
namespace {

/// A tag whose corners lie further than this from where the body's pose puts them [px rms]
/// contradicts the others: it was misread, or it is not where the manifest says.
constexpr double kContradiction = 3.0;
/// Two hypotheses nearer than this are one.
constexpr double kSameRotation = 0.02;  // [rad]
/// The odds at which one planar solution is believed: exp(14 / 2), 1000 to 1.
constexpr double kDecisiveCost = 14.0;
/// Where a body may turn and move between two looks, for continuity's vote [rad]; and the most that
/// the vote weighs, so that a wrong pose can be outvoted later.
constexpr double kTurnBetweenLooks = 0.15;
constexpr double kMaxContinuityCost = 25.0;

const TagPlacement* find_placement(const std::vector<TagPlacement>& placements,
                                   const MarkerId& id) {
  const auto found = std::find_if(placements.begin(), placements.end(),
                                  [&](const TagPlacement& one) { return one.id == id; });
  return found == placements.end() ? nullptr : &*found;
}

bool is_finite(const TagDetection& detection) {
  return std::all_of(detection.corners.begin(), detection.corners.end(),
                     [](const Eigen::Vector2d& corner) { return corner.allFinite(); });
}

double sigma_of(const TagDetection& detection, const BodyPoseOptions& options) {
  const double own = detection.corner_sigma > 0.0 ? detection.corner_sigma : options.corner_sigma;
  return std::hypot(own, options.model_sigma);
}

BodyPoseProblem pose_problem(const std::vector<TagPlacement>& placements,
                             const std::vector<TagDetection>& detections, const CameraModel& camera,
                             const BodyPoseHints& hints, const BodyPoseOptions& options) {
  BodyPoseProblem problem{camera, {}};
  for (const TagDetection& detection : detections) {
    const TagPlacement* placement = find_placement(placements, detection.id);
    if (placement == nullptr || !is_finite(detection)) continue;
    SeenTag tag{placement->T_body_marker, placement->size, tag_corners(placement->size),
                detection.corners, sigma_of(detection, options)};
    for (Eigen::Vector3d& corner : tag.corners_body) corner = tag.T_body_marker * corner;
    problem.tags.push_back(tag);
  }
  if (hints.depth == nullptr) return problem;
  const CameraModel depth_camera = on_grid(camera, hints.depth->width(), hints.depth->height());
  for (SeenTag& tag : problem.tags) {
    std::array<Eigen::Vector2d, 4> pixels = tag.pixels;
    for (Eigen::Vector2d& pixel : pixels) pixel = to_grid(pixel, camera, depth_camera);
    tag.plane = measure_tag_plane(*hints.depth, hints.depth_noise, depth_camera, pixels,
                                  static_cast<int>(problem.tags.size()));
  }
  return problem;
}

std::vector<Pose> start_poses(const BodyPoseProblem& problem) {
  std::vector<Pose> starts;
  for (const SeenTag& tag : problem.tags) {
    std::array<Eigen::Vector2d, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = problem.camera.normalise(tag.pixels[i]);
    for (const Pose& T_camera_marker : planar_poses(corners, tag.size)) {
      starts.push_back(T_camera_marker * tag.T_body_marker.inverse());
    }
  }
  return starts;
}

double continuity_cost(const Pose& T_camera_body, const BodyPoseHints& hints) {
  if (!hints.T_camera_body) return 0.0;
  const double turn = rotation_distance(T_camera_body, *hints.T_camera_body) / kTurnBetweenLooks;
  return std::min(turn * turn, kMaxContinuityCost);
}

/// Marks the tags that the pose explains as used; returns their number.
int mark_used(BodyPoseProblem& problem, const Pose& T_camera_body) {
  int used = 0;
  for (SeenTag& tag : problem.tags) {
    tag.is_used = corner_rms(problem, tag, T_camera_body) <= kContradiction;
    if (tag.is_used) ++used;
  }
  return used;
}

struct Hypothesis {
  RefinedPose refined;
  double cost = 0.0;  ///< over all tags, each at most as bad as a contradiction, and continuity
};

/// The cost over all tags; one that contradicts costs the same however far off it is.
double cost_of_all(const BodyPoseProblem& problem, const Pose& pose, const BodyPoseHints& hints) {
  double cost = continuity_cost(pose, hints);
  for (const SeenTag& tag : problem.tags) {
    cost += std::min(tag_cost(problem, tag, pose), 4.0 * huber(kContradiction / tag.sigma));
  }
  return cost;
}

/// How much larger the squared residuals are than their deviations say: 1 where the model holds,
/// more where the lens, the print or the placements are off.
double misfit(const BodyPoseProblem& problem, const RefinedPose& refined) {
  int residuals = 0;
  for (const SeenTag& tag : problem.tags) {
    if (tag.is_used) residuals += tag.plane ? 11 : 8;
  }
  return std::max(1.0, refined.cost / std::max(1, residuals - 6));
}

std::vector<Hypothesis> refined_hypotheses(const BodyPoseProblem& problem,
                                           const BodyPoseHints& hints) {
  std::vector<Hypothesis> hypotheses;
  for (const Pose& start : start_poses(problem)) {
    BodyPoseProblem own = problem;
    Pose pose = start;
    std::optional<RefinedPose> refined;
    for (int round = 0; round < 2; ++round) {
      if (mark_used(own, pose) == 0) break;
      refined = refine_body_pose(own, pose);
      if (!refined) break;
      pose = refined->T_camera_body;
    }
    if (!refined) continue;
    hypotheses.push_back({*refined, cost_of_all(problem, pose, hints)});
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.cost < b.cost; });
  return hypotheses;
}

BodyPoseCandidate candidate(const Hypothesis& hypothesis) {
  return {hypothesis.refined.T_camera_body, hypothesis.refined.pixel_rms};
}

}  // namespace

std::array<Eigen::Vector3d, 4> tag_corners(double size) {
  const double h = 0.5 * size;
  return {Eigen::Vector3d(-h, -h, 0.0), Eigen::Vector3d(h, -h, 0.0), Eigen::Vector3d(h, h, 0.0),
          Eigen::Vector3d(-h, h, 0.0)};
}

std::vector<TagPlacement> base_placements(const Manifest& manifest) {
  std::vector<TagPlacement> placements;
  for (const MarkerEntry& marker : manifest.markers) {
    if (marker.role != MarkerRole::base) continue;
    placements.push_back({marker.id, marker.size, marker.T_parent_marker});
  }
  return placements;
}

std::vector<TagPlacement> object_placements(const Manifest& manifest, const std::string& object) {
  std::vector<TagPlacement> placements;
  for (const MarkerEntry& marker : manifest.markers) {
    if (marker.role != MarkerRole::object || marker.object != object) continue;
    placements.push_back({marker.id, marker.size, marker.T_parent_marker});
  }
  return placements;
}

BodyPose solve_body_pose(const std::vector<TagPlacement>& placements,
                         const std::vector<TagDetection>& detections, const CameraModel& camera,
                         const BodyPoseHints& hints, const BodyPoseOptions& options) {
  PCAVR_REQUIRE(options.corner_sigma > 0.0, options.corner_sigma);
  PCAVR_REQUIRE(options.model_sigma >= 0.0, options.model_sigma);
  BodyPoseProblem problem = pose_problem(placements, detections, camera, hints, options);
  BodyPose result;
  if (problem.tags.empty()) return result;
  const std::vector<Hypothesis> hypotheses = refined_hypotheses(problem, hints);
  result.status = BodyPoseStatus::failed;
  if (hypotheses.empty()) return result;

  const Hypothesis& best = hypotheses.front();
  result.status = BodyPoseStatus::solved;
  result.pose = candidate(best);
  result.tags_used = mark_used(problem, best.refined.T_camera_body);
  result.tags_rejected = static_cast<int>(problem.tags.size()) - result.tags_used;
  const double scale = misfit(problem, best.refined);
  result.covariance = best.refined.information.ldlt().solve(Matrix6d::Identity()) * scale;
  for (const Hypothesis& other : hypotheses) {
    if (rotation_distance(best.refined.T_camera_body, other.refined.T_camera_body) <
        kSameRotation) {
      continue;
    }
    result.alternative = candidate(other);
    if (other.cost - best.cost < kDecisiveCost * scale) result.status = BodyPoseStatus::ambiguous;
    break;
  }
  if (result.tags_used == 0) result.status = BodyPoseStatus::failed;
  return result;
}

}  // namespace pcavr
