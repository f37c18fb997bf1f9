// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_anchor.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr::tracking {
namespace {

// Tracking drifts before the graph is solved: contradictions are weighed on this scale.
constexpr double kPixelScale = 5.0;      // [px]
constexpr double kPositionScale = 0.03;  // [m]
// So many frames, spread evenly, bear witness; more would only cost time.
constexpr std::size_t kMaxSights = 60;

double gentle(double scaled) { return std::log1p(scaled * scaled); }

bool has_tag_pose(const FrameRecord& record) {
  return record.base_from_tags.status == BodyPoseStatus::solved ||
         record.base_from_tags.status == BodyPoseStatus::ambiguous;
}

double contradiction(const AnchorSight& sight, const Pose& T_base_segment,
                     const std::vector<TagPlacement>& base_tags, const Trajectory& groundtruth,
                     const CameraModel& camera) {
  const Pose T_base_camera = T_base_segment * sight.T_segment_camera;
  const Pose T_color_base = (T_base_camera * sight.record->T_depth_color).inverse();
  double sum = 0.0;
  for (const TagDetection& tag : sight.record->base_tags) {
    const auto corners = corners_in_base(base_tags, tag.id);
    if (!corners) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d p = T_color_base * (*corners)[i];
      const double error = p.z() > 1e-3 ? (camera.project(p) - tag.corners[i]).norm() : 1e4;
      sum += gentle(error / kPixelScale);
    }
  }
  if (const auto measured = groundtruth.at(sight.record->stamp)) {
    sum += gentle(translation_distance(*measured, T_base_camera) / kPositionScale);
  }
  return sum;
}

std::vector<AnchorSight> spread(const std::vector<AnchorSight>& sights,
                                const Trajectory& groundtruth) {
  std::vector<AnchorSight> useful;
  for (const AnchorSight& sight : sights) {
    if (has_tag_pose(*sight.record) || groundtruth.at(sight.record->stamp)) {
      useful.push_back(sight);
    }
  }
  if (useful.size() <= kMaxSights) return useful;
  std::vector<AnchorSight> chosen;
  for (std::size_t i = 0; i < kMaxSights; ++i) {
    chosen.push_back(useful[i * useful.size() / kMaxSights]);
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

std::optional<Pose> anchor_segment(const std::vector<AnchorSight>& sights,
                                   const std::vector<TagPlacement>& base_tags,
                                   const Trajectory& groundtruth, const CameraModel& camera) {
  const std::vector<AnchorSight> useful = spread(sights, groundtruth);
  std::vector<Pose> hypotheses;
  for (const AnchorSight& sight : useful) {
    const Pose T_camera_segment = sight.T_segment_camera.inverse();
    const BodyPose& base = sight.record->base_from_tags;
    if (has_tag_pose(*sight.record)) {
      const Pose T_color_segment = sight.record->T_depth_color.inverse() * T_camera_segment;
      hypotheses.push_back(base.pose.T_camera_body.inverse() * T_color_segment);
      if (base.alternative) {
        hypotheses.push_back(base.alternative->T_camera_body.inverse() * T_color_segment);
      }
    }
    if (const auto measured = groundtruth.at(sight.record->stamp)) {
      hypotheses.push_back(*measured * T_camera_segment);
    }
  }
  std::optional<Pose> best;
  double least = HUGE_VAL;
  for (const Pose& hypothesis : hypotheses) {
    double sum = 0.0;
    for (const AnchorSight& sight : useful) {
      sum += contradiction(sight, hypothesis, base_tags, groundtruth, camera);
    }
    if (sum < least) {
      least = sum;
      best = hypothesis;
    }
  }
  return best;
}

}  // namespace pcavr::tracking
