// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/marker/body_pose.hpp"

namespace pcavr {

/// A tag of a rigid body, as far as it is known before the images are used.
struct LayoutTag {
  MarkerId id;
  double size = 0.0;                    ///< [m]
  std::optional<Pose> T_body_tag = {};  ///< where it is said to be
  bool is_fixed = false;                ///< its stated pose is right, and defines the body's frame
};

/// Where a tag is by the images, against where it is said to be.
struct TagShift {
  double offset = 0.0;     ///< [m]
  double rotation = 0.0;   ///< [rad]
  bool has_moved = false;  ///< by more than a ruler's error and the noise
};

/// A tag that was at two places while the images were taken.
struct TagMove {
  std::size_t last_before = 0;  ///< index of the last frame that shows it at its first place
  std::size_t first_after = 0;  ///< index of the first frame that shows it at its second place
  double offset = 0.0;          ///< [m]
  double rotation = 0.0;        ///< [rad]
};

struct LaidOutTag {
  MarkerId id;
  double size = 0.0;
  Pose T_body_tag = {};
  /// Of the twist [v; w] in the tag's axes, against the frame that the reference tags define: 0 for
  /// a tag that alone is the reference.
  Matrix6d covariance = Matrix6d::Zero();
  std::size_t views = 0;               ///< images that were used
  std::size_t rejected = 0;            ///< images in which its corners do not fit
  double pixel_rms = 0.0;              ///< [px] per corner
  bool is_reference = false;           ///< one of those whose stated poses define the body's frame
  std::optional<TagShift> shift = {};  ///< where it has a stated pose
  std::optional<TagMove> move = {};    ///< its pose above is the later one

  [[nodiscard]] double position_std() const;  ///< [m] in the worst direction
  [[nodiscard]] double rotation_std() const;  ///< [rad] about the worst axis
};

struct TagLayout {
  std::vector<LaidOutTag> tags = {};    ///< in the order of the input; those that are linked
  std::vector<MarkerId> unlinked = {};  ///< in no image together with the others
  std::vector<std::optional<Pose>> T_body_camera = {};  ///< by frame; empty: not used
  double pixel_rms = 0.0;                               ///< [px] per corner, of what was used
  double correlation = 1.0;             ///< factor of the variances, by similar views
  std::vector<std::string> notes = {};  ///< for the user
};

/// Finds where the tags of one rigid body are relative to each other, from images that show two or
/// more of them at once, taken from anywhere: least squares over all corners, tags and cameras
/// (bundle adjustment), robust. `frames` are in order of time. The body's frame is that of the
/// fixed tags; without any, of those stated poses that agree with the images, which must be more
/// than those that agree otherwise; without stated poses, of the first tag. An Error names the
/// tags where stated poses disagree and nothing shows which is right, and where no two tags are in
/// one image. Standard deviations are those of the residuals, widened where residuals of
/// successive images are correlated. Thread-safe.
[[nodiscard]] Expected<TagLayout> solve_tag_layout(
    const std::vector<LayoutTag>& tags, const std::vector<std::vector<TagDetection>>& frames,
    const CameraModel& camera, const BodyPoseOptions& options = {});

}  // namespace pcavr
