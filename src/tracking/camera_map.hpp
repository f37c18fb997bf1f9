// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "pcavr/core/stamp.hpp"
#include "pcavr/marker/body_pose.hpp"
#include "pcavr/marker/tag_detector.hpp"

#include "camera_features.hpp"
#include "camera_surface.hpp"

namespace pcavr::tracking {

/// A frame that others are aligned to; all that stays of its images.
struct Keyframe {
  std::size_t record = 0;  ///< its own in the track's frames
  int segment = 0;         ///< keyframes of one segment are linked by alignments
  Pose T_segment_keyframe;
  SurfaceModel model;
  cv::Mat gray;
  std::vector<cv::Point2f> corners;  ///< [px]
  Pose T_depth_color;
};

/// A measured pose of a frame in a keyframe.
struct FrameLink {
  std::size_t keyframe = 0;
  Pose T_keyframe_frame;
  Matrix6d information = Matrix6d::Zero();  ///< of [v; w] in the frame's axes
};

/// What stays of every frame.
struct FrameRecord {
  std::size_t index = 0;         ///< in Recording::frames
  Stamp stamp;                   ///< of the depth image
  std::vector<FrameLink> links;  ///< none: lost
  Pose T_depth_color;            ///< the colour camera at its stamp, in the depth camera at its own
  std::vector<TagDetection> base_tags;
  BodyPose base_from_tags;  ///< in the colour camera
};

/// A frame's images as alignment wants them.
struct FrameView {
  InverseDepth inverse_depth;
  cv::Mat gray;
  Pyramid pyramid;
  Pose T_depth_color;
};

/// A keyframe made ready to be aligned to.
struct ActiveModel {
  std::size_t keyframe = 0;
  Surface surface;
  Pyramid pyramid;
  std::vector<Landmark> landmarks;
};

/// The camera and noise that all alignments share.
struct Sensor {
  CameraModel camera;
  DepthNoise noise;
  CellGrid grid;
};

[[nodiscard]] ActiveModel activate(const Sensor& sensor, const std::vector<Keyframe>& keyframes,
                                   std::size_t keyframe);

/// Brings surface and landmarks up to date with what the keyframe's model has taken in.
void refresh(const Sensor& sensor, const Keyframe& keyframe, ActiveModel& active);

/// Aligns a frame to a keyframe: optical flow from the predicted pose, then surface and features
/// together.
[[nodiscard]] Alignment match(const Sensor& sensor, const ActiveModel& model,
                              const FrameView& frame, const Pose& T_keyframe_frame_predicted,
                              Parallelism parallelism);

}  // namespace pcavr::tracking
