// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Pose of a tag in the body that it is fixed to (base or an object).
struct TagPlacement {
  MarkerId id;
  double size = 0.0;  ///< [m]
  Pose T_body_marker;
  Matrix6d covariance = Matrix6d::Zero();  ///< MarkerEntry::covariance: of T_body_marker * exp()
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
  ambiguous,  ///< planar ambiguity: two solutions fit equally well; `pose` is the better one
  not_seen,   ///< none of the body's tags was detected
  failed,     ///< no pose fits the corners
};

struct BodyPose {
  BodyPoseStatus status = BodyPoseStatus::not_seen;
  BodyPoseCandidate pose;
  /// The other solution of the planar (two-fold) pose ambiguity, if there is one.
  std::optional<BodyPoseCandidate> second_solution = {};
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist [v; w] in body axes: T * exp([v; w])
  int tags_used = 0;
  int tags_rejected = 0;  ///< outliers: detected, but inconsistent with the other tags
};

/// Optional inputs that resolve the planar ambiguity and refine the pose.
struct BodyPoseHints {
  /// Registered to the image in which the tags were detected: of the same size, or downscaled by
  /// one factor.
  const DepthImage* depth = nullptr;
  DepthNoise depth_noise = {};
  std::optional<Pose> T_camera_body = {};  ///< pose in the previous frame
};

/// See src/perception/marker/options.cpp for meanings, ranges and defaults.
struct BodyPoseOptions {
  BodyPoseOptions();

  double corner_std;              ///< [px]
  double model_std;               ///< [px]
  double max_tag_residual;        ///< [px]
  double min_cost_gap;            ///< [-2 log likelihood]
  double rotation_std;            ///< [rad]
  double depth_correlation_area;  ///< [px^2]
  double distortion_length;       ///< of the distance
};

/// The options "marker.body_pose".
[[nodiscard]] OptionSection section_of(BodyPoseOptions& options);

/// The pose of a rigid body from all of its tags at once (a tag bundle). Both planar solutions
/// [Collins & Bartoli 2014 (IPPE)] of each tag are initial guesses; each is refined by robust
/// Gauss-Newton on all inlier corners and on the depth inside the tags, and the one with the lowest
/// cost over tags, depth and continuity is selected. Tags count the less, the larger the covariance
/// of their placement is, which is so contained in the pose's. Thread-safe.
[[nodiscard]] BodyPose solve_body_pose(const std::vector<TagPlacement>& placements,
                                       const std::vector<TagDetection>& detections,
                                       const CameraModel& camera, const BodyPoseHints& hints = {},
                                       const BodyPoseOptions& options = {});

}  // namespace pcavr
