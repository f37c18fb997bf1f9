// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/perception/marker/tag_layout.hpp"

#include "perception/marker/layout_fit.hpp"

namespace pcavr {

/// The detections of a body's tags by frame: what has no tag of the body is empty.
struct LayoutInput {
  std::vector<LayoutTag> tags = {};
  std::vector<std::vector<TagDetection>> frames = {};
  CameraModel camera;
  BodyPoseOptions options = {};
};

/// The tags that images link with the one that is in most of them, placed relative to it one after
/// the other by the images that show the most pairs (a maximum spanning tree).
struct LayoutStart {
  std::vector<std::size_t> tags = {};  ///< indices of LayoutInput::tags; the datum is the first
  std::vector<Pose> T_datum_tag = {};  ///< of these
};
[[nodiscard]] LayoutStart start_layout(const LayoutInput& input);

/// The problem with the camera of each frame that shows two placed tags or more, and whose camera
/// they determine.
[[nodiscard]] LayoutProblem place_cameras(const LayoutInput& input, const LayoutStart& start);

}  // namespace pcavr
