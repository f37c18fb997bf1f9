// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/marker/body_pose.hpp"

namespace pcavr {

/// Two tags of one rigid body in one image.
struct TagPairView {
  TagDetection first;
  TagDetection second;
};

/// The pose of one tag in another one's frame, by images that show both.
struct TagPairPose {
  Pose T_first_second;
  Matrix6d covariance = Matrix6d::Zero();  ///< of T_first_second * exp([v; w])
  double reprojection_rms = 0.0;           ///< [px], per corner
  std::size_t views = 0;                   ///< that were used
};

/// Least squares over the corners in all views (bundle adjustment), robust, independent of where
/// the tags are said to be: `T_first_second_stated` is one of the initial guesses, and decides
/// between solutions that the images do not distinguish (planar ambiguity). Nothing where no view
/// determines the pose. At most 24 views are used, evenly spaced. Thread-safe.
[[nodiscard]] std::optional<TagPairPose> solve_tag_pair(const std::vector<TagPairView>& views,
                                                        double first_size, double second_size,
                                                        const Pose& T_first_second_stated,
                                                        const CameraModel& camera,
                                                        const BodyPoseOptions& options = {});

}  // namespace pcavr
