// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/marker/tag_detector.hpp"

namespace pcavr {

/// Where a tag stands in the body it is fixed to (base or an object).
struct TagPlacement {
  MarkerId id;
  double size = 0.0;  ///< [m]
  Pose T_body_marker;
};

/// The placements of the manifest's base markers, or of one object's.
[[nodiscard]] std::vector<TagPlacement> base_placements(const Manifest& manifest);
[[nodiscard]] std::vector<TagPlacement> object_placements(const Manifest& manifest,
                                                          const std::string& object);

/// Corners of a tag in the marker frame, in the order of TagDetection::corners [m].
[[nodiscard]] std::array<Eigen::Vector3d, 4> tag_corners(double size);

/// One hypothesis for a body's pose.
struct BodyPoseCandidate {
  Pose T_camera_body;
  double reprojection_rms = 0.0;  ///< [px]
};

enum class BodyPoseStatus {
  solved,
  ambiguous,  ///< two planar solutions explain all there is equally well; `pose` is the better one
  not_seen,   ///< none of the body's tags was detected
  failed,     ///< the corners fit no pose
};

struct BodyPose {
  BodyPoseStatus status = BodyPoseStatus::not_seen;
  BodyPoseCandidate pose;
  std::optional<BodyPoseCandidate> alternative = {};  ///< the other planar solution, if one exists
  Matrix6d covariance = Matrix6d::Zero();             ///< of [v; w] in body axes: T * exp([v; w])
  int tags_used = 0;
  int tags_rejected = 0;  ///< seen, but their corners contradict the others'
};

/// What may help to choose between the two planar solutions, and to refine the one chosen.
struct BodyPoseHints {
  /// Registered to the image that the tags were found in, and as large, or smaller by one factor.
  const DepthImage* depth = nullptr;
  DepthNoise depth_noise = {};
  std::optional<Pose> T_camera_body = {};  ///< where it was a moment ago
};

struct BodyPoseOptions {
  double corner_sigma = 0.15;  ///< [px], of a corner coordinate whose detection does not say; > 0
  /// [px], what comes on top of it: the lens model's error, paper that is not flat; >= 0. Where the
  /// residuals turn out larger than both say, the covariance is scaled up by them.
  double model_sigma = 0.03;
};

/// The pose of a rigid body from all of its tags at once. Both planar solutions [Collins & Bartoli
/// 2014 (IPPE)] of each tag are starts; tags, depth and continuity vote; the winner is refined on
/// all inlier corners and the depth inside the tags by robust Gauss-Newton. Thread-safe.
[[nodiscard]] BodyPose solve_body_pose(const std::vector<TagPlacement>& placements,
                                       const std::vector<TagDetection>& detections,
                                       const CameraModel& camera, const BodyPoseHints& hints = {},
                                       const BodyPoseOptions& options = {});

}  // namespace pcavr
