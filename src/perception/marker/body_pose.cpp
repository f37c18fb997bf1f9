// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/body_pose.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"

#include "perception/marker/body_pose_problem.hpp"
#include "perception/marker/planar_pose.hpp"

namespace pcavr {
namespace {

/// Hypotheses closer than this are the same: planar solutions differ by more [rad].
constexpr double kSameRotation = 0.02;
/// Bound of the continuity cost, so that a wrong pose can be corrected later: five stds squared.
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

/// [m^2] Of a corner in the tag's plane, by the covariance of where the tag is: mean over both axes
/// and the four corners.
double placement_variance(const TagPlacement& placement) {
  double sum = 0.0;
  for (const Eigen::Vector3d& corner : tag_corners(placement.size)) {
    Eigen::Matrix<double, 2, 6> moves = Eigen::Matrix<double, 2, 6>::Zero();
    moves.leftCols<2>().setIdentity();
    // w x corner, of which z is 0.
    moves(0, 5) = -corner.y();
    moves(1, 5) = corner.x();
    sum += (moves * placement.covariance * moves.transpose()).trace() / 8.0;
  }
  return sum;
}

/// [px] Of one pixel coordinate of a corner. The corners of a tag share the error of its placement:
/// each has four times that variance, so that all four together have it once.
double corner_std_of(const TagDetection& detection, const TagPlacement& placement,
                     const BodyPoseOptions& options) {
  const double own = detection.corner_std > 0.0 ? detection.corner_std : options.corner_std;
  const double pixels = std::hypot(own, options.model_std);
  if (placement.covariance.isZero()) return pixels;
  double edges = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    edges += 0.25 * (detection.corners[(i + 1) % 4] - detection.corners[i]).norm();
  }
  const double pixels_per_metre = edges / placement.size;
  return std::hypot(pixels, pixels_per_metre * 2.0 * std::sqrt(placement_variance(placement)));
}

BodyPoseProblem pose_problem(const std::vector<TagPlacement>& placements,
                             const std::vector<TagDetection>& detections, const CameraModel& camera,
                             const BodyPoseHints& hints, const BodyPoseOptions& options) {
  BodyPoseProblem problem{camera, {}};
  for (const TagDetection& detection : detections) {
    const TagPlacement* placement = find_placement(placements, detection.id);
    if (placement == nullptr || !is_finite(detection)) continue;
    SeenTag tag{placement->T_body_marker, placement->size, tag_corners(placement->size),
                detection.corners, corner_std_of(detection, *placement, options)};
    for (Eigen::Vector3d& corner : tag.corners_body) corner = tag.T_body_marker * corner;
    problem.tags.push_back(tag);
  }
  if (hints.depth == nullptr) return problem;
  const CameraModel depth_camera = on_grid(camera, hints.depth->width(), hints.depth->height());
  for (SeenTag& tag : problem.tags) {
    std::array<Eigen::Vector2d, 4> pixels = tag.pixels;
    for (Eigen::Vector2d& pixel : pixels) pixel = to_grid(pixel, camera, depth_camera);
    tag.plane = measure_tag_plane(*hints.depth, hints.depth_noise, depth_camera, pixels,
                                  static_cast<int>(problem.tags.size()), options);
  }
  return problem;
}

/// Initial guesses: both planar solutions of every tag.
std::vector<Pose> initial_poses(const BodyPoseProblem& problem) {
  std::vector<Pose> poses;
  for (const SeenTag& tag : problem.tags) {
    std::array<Eigen::Vector2d, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = problem.camera.normalise(tag.pixels[i]);
    for (const Pose& T_camera_marker : planar_poses(corners, tag.size)) {
      poses.push_back(T_camera_marker * tag.T_body_marker.inverse());
    }
  }
  return poses;
}

double continuity_cost(const Pose& T_camera_body, const BodyPoseHints& hints,
                       const BodyPoseOptions& options) {
  if (!hints.T_camera_body) return 0.0;
  const double rotation =
      rotation_distance(T_camera_body, *hints.T_camera_body) / options.rotation_std;
  return std::min(rotation * rotation, kMaxContinuityCost);
}

/// Marks the inlier tags of the pose as used; returns their number.
int select_inliers(BodyPoseProblem& problem, const Pose& T_camera_body,
                   const BodyPoseOptions& options) {
  int used = 0;
  for (SeenTag& tag : problem.tags) {
    tag.is_used = corner_rms(problem, tag, T_camera_body) <= options.max_tag_residual;
    if (tag.is_used) ++used;
  }
  return used;
}

struct Hypothesis {
  RefinedPose refined;
  double cost = 0.0;  ///< over all tags, bounded for each, plus continuity
};

/// The cost over all tags, truncated for outliers, plus continuity.
double total_cost(const BodyPoseProblem& problem, const Pose& pose, const BodyPoseHints& hints,
                  const BodyPoseOptions& options) {
  double cost = continuity_cost(pose, hints, options);
  for (const SeenTag& tag : problem.tags) {
    cost += std::min(tag_cost(problem, tag, pose),
                     4.0 * huber_loss(options.max_tag_residual / tag.corner_std));
  }
  return cost;
}

/// Variance factor (reduced chi-square), at least 1: above 1 if the residuals are larger than their
/// standard deviations, because of errors of the lens model, the print or the placements.
double variance_factor(const BodyPoseProblem& problem, const RefinedPose& refined) {
  int residuals = 0;
  for (const SeenTag& tag : problem.tags) {
    if (tag.is_used) residuals += tag.plane ? 11 : 8;
  }
  return std::max(1.0, refined.cost / std::max(1, residuals - 6));
}

/// Hypotheses refined from all initial guesses, in ascending order of cost.
std::vector<Hypothesis> refined_hypotheses(const BodyPoseProblem& problem,
                                           const BodyPoseHints& hints,
                                           const BodyPoseOptions& options) {
  std::vector<Hypothesis> hypotheses;
  for (const Pose& initial : initial_poses(problem)) {
    BodyPoseProblem inlier_problem = problem;
    Pose pose = initial;
    std::optional<RefinedPose> refined;
    for (int round = 0; round < 2; ++round) {
      if (select_inliers(inlier_problem, pose, options) == 0) break;
      refined = refine_body_pose(inlier_problem, pose);
      if (!refined) break;
      pose = refined->T_camera_body;
    }
    if (!refined) continue;
    hypotheses.push_back({*refined, total_cost(problem, pose, hints, options)});
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
    placements.push_back({marker.id, marker.size, marker.T_parent_marker, marker.covariance});
  }
  return placements;
}

std::vector<TagPlacement> object_placements(const Manifest& manifest, const std::string& object) {
  std::vector<TagPlacement> placements;
  for (const MarkerEntry& marker : manifest.markers) {
    if (marker.role != MarkerRole::object || marker.object != object) continue;
    placements.push_back({marker.id, marker.size, marker.T_parent_marker, marker.covariance});
  }
  return placements;
}

BodyPose solve_body_pose(const std::vector<TagPlacement>& placements,
                         const std::vector<TagDetection>& detections, const CameraModel& camera,
                         const BodyPoseHints& hints, const BodyPoseOptions& options) {
  PCAVR_REQUIRE(options.corner_std > 0.0, options.corner_std);
  PCAVR_REQUIRE(options.model_std >= 0.0, options.model_std);
  BodyPoseProblem problem = pose_problem(placements, detections, camera, hints, options);
  BodyPose result;
  if (problem.tags.empty()) return result;
  const std::vector<Hypothesis> hypotheses = refined_hypotheses(problem, hints, options);
  result.status = BodyPoseStatus::failed;
  if (hypotheses.empty()) return result;

  const Hypothesis& best = hypotheses.front();
  result.status = BodyPoseStatus::solved;
  result.pose = candidate(best);
  result.tags_used = select_inliers(problem, best.refined.T_camera_body, options);
  result.tags_rejected = static_cast<int>(problem.tags.size()) - result.tags_used;
  const double scale = variance_factor(problem, best.refined);
  result.covariance = best.refined.information.ldlt().solve(Matrix6d::Identity()) * scale;
  for (const Hypothesis& other : hypotheses) {
    if (rotation_distance(best.refined.T_camera_body, other.refined.T_camera_body) <
        kSameRotation) {
      continue;
    }
    result.second_solution = candidate(other);
    if (other.cost - best.cost < options.min_cost_gap * scale) {
      result.status = BodyPoseStatus::ambiguous;
    }
    break;
  }
  if (result.tags_used == 0) result.status = BodyPoseStatus::failed;
  return result;
}

}  // namespace pcavr
