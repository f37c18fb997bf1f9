// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_anchor.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr::tracking {
namespace {

// Loss scales: wide, because tracking has drift before the graph is solved.
constexpr double kPixelScale = 5.0;      // [px]
constexpr double kPositionScale = 0.03;  // [m]
// Frames that are evaluated, evenly spaced; more would only cost time.
constexpr std::size_t kMaxObservations = 60;

/// Cauchy loss: bounded influence of outliers.
double cauchy_loss(double scaled) { return std::log1p(scaled * scaled); }

bool has_tag_pose(const FrameRecord& record) {
  return record.base_from_tags.status == BodyPoseStatus::solved ||
         record.base_from_tags.status == BodyPoseStatus::ambiguous;
}

double anchor_cost(const AnchorObservation& observation, const Pose& T_base_segment,
                   const std::vector<TagPlacement>& base_tags, const Trajectory& groundtruth,
                   const CameraModel& camera) {
  const Pose T_base_camera = T_base_segment * observation.T_segment_camera;
  const Pose T_color_base = (T_base_camera * observation.record->T_depth_color).inverse();
  double sum = 0.0;
  for (const TagDetection& tag : observation.record->base_tags) {
    const auto corners = corners_in_base(base_tags, tag.id);
    if (!corners) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d p = T_color_base * (*corners)[i];
      const double error = p.z() > 1e-3 ? (camera.project(p) - tag.corners[i]).norm() : 1e4;
      sum += cauchy_loss(error / kPixelScale);
    }
  }
  if (const auto measured = groundtruth.at(observation.record->stamp)) {
    sum += cauchy_loss(translation_distance(*measured, T_base_camera) / kPositionScale);
  }
  return sum;
}

/// The observations with a tag or a given pose, evenly subsampled.
std::vector<AnchorObservation> subsample(const std::vector<AnchorObservation>& observations,
                                         const Trajectory& groundtruth) {
  std::vector<AnchorObservation> useful;
  for (const AnchorObservation& observation : observations) {
    if (has_tag_pose(*observation.record) || groundtruth.at(observation.record->stamp)) {
      useful.push_back(observation);
    }
  }
  if (useful.size() <= kMaxObservations) return useful;
  std::vector<AnchorObservation> chosen;
  for (std::size_t i = 0; i < kMaxObservations; ++i) {
    chosen.push_back(useful[i * useful.size() / kMaxObservations]);
  }
  return chosen;
}

}  // namespace

std::optional<std::array<Eigen::Vector3d, 4>> corners_in_base(
    const std::vector<TagPlacement>& base_tags, const MarkerId& id) {
  for (const TagPlacement& tag : base_tags) {
    if (tag.id != id) continue;
    std::array<Eigen::Vector3d, 4> corners = tag_corners(tag.size);
    for (Eigen::Vector3d& corner : corners) corner = tag.T_body_marker * corner;
    return corners;
  }
  return std::nullopt;
}

std::optional<Pose> anchor_segment(const std::vector<AnchorObservation>& observations,
                                   const std::vector<TagPlacement>& base_tags,
                                   const Trajectory& groundtruth, const CameraModel& camera) {
  const std::vector<AnchorObservation> useful = subsample(observations, groundtruth);
  std::vector<Pose> hypotheses;
  for (const AnchorObservation& observation : useful) {
    const Pose T_camera_segment = observation.T_segment_camera.inverse();
    const BodyPose& base = observation.record->base_from_tags;
    if (has_tag_pose(*observation.record)) {
      const Pose T_color_segment = observation.record->T_depth_color.inverse() * T_camera_segment;
      hypotheses.push_back(base.pose.T_camera_body.inverse() * T_color_segment);
      if (base.second_solution) {
        hypotheses.push_back(base.second_solution->T_camera_body.inverse() * T_color_segment);
      }
    }
    if (const auto measured = groundtruth.at(observation.record->stamp)) {
      hypotheses.push_back(*measured * T_camera_segment);
    }
  }
  std::optional<Pose> best;
  double min_cost = HUGE_VAL;
  for (const Pose& hypothesis : hypotheses) {
    double cost = 0.0;
    for (const AnchorObservation& observation : useful) {
      cost += anchor_cost(observation, hypothesis, base_tags, groundtruth, camera);
    }
    if (cost < min_cost) {
      min_cost = cost;
      best = hypothesis;
    }
  }
  return best;
}

}  // namespace pcavr::tracking
