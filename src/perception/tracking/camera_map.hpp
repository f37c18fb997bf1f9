// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"

#include "camera_features.hpp"
#include "camera_surface.hpp"

namespace pcavr::tracking {

/// A frame that others are aligned to; the data kept of its images.
struct Keyframe {
  std::size_t record = 0;  ///< index of its frame record
  int segment = 0;         ///< keyframes of one segment are linked by alignments
  Pose T_segment_keyframe;
  SurfaceModel model;
  cv::Mat gray;
  std::vector<cv::Point2f> corners;  ///< [px]
  Pose T_depth_color;
};

/// A measured pose of a frame in a keyframe: an edge of the pose graph.
struct FrameLink {
  std::size_t keyframe = 0;
  Pose T_keyframe_frame;
  Matrix6d information = Matrix6d::Zero();  ///< of [v; w] in the frame's axes
};

/// Data kept of every frame.
struct FrameRecord {
  std::size_t index = 0;         ///< in Recording::frames
  Stamp stamp;                   ///< of the depth image
  std::vector<FrameLink> links;  ///< empty if lost
  Pose T_depth_color;            ///< colour camera at its stamp in the depth camera at its stamp
  std::vector<TagDetection> base_tags;
  BodyPose base_from_tags;  ///< in the colour camera
};

/// A frame's images, preprocessed for alignment.
struct FrameView {
  InverseDepth inverse_depth;
  cv::Mat gray;
  cv::Mat texture;  ///< see View
  Pyramid pyramid;
  Pose T_depth_color;
};

/// A keyframe with the data precomputed for alignment.
struct ActiveModel {
  std::size_t keyframe = 0;
  InverseDepth inverse_depth;  ///< before frames were fused into it
  cv::Mat texture;             ///< see View
  Pose T_depth_color;
  Surface surface;
  Pyramid pyramid;
  std::vector<Landmark> landmarks;
};

/// Camera and noise model of all alignments.
struct Sensor {
  CameraModel camera;
  DepthNoise noise;
  CellGrid grid;
};

[[nodiscard]] ActiveModel activate(const Sensor& sensor, const std::vector<Keyframe>& keyframes,
                                   std::size_t keyframe);

/// Recomputes surface and landmarks after frames were fused into the keyframe's model.
void refresh(const Sensor& sensor, const Keyframe& keyframe, ActiveModel& active);

/// Aligns a frame to a keyframe: optical flow from the predicted pose, then surface and features
/// together.
[[nodiscard]] Alignment match(const Sensor& sensor, const ActiveModel& model,
                              const FrameView& frame, const Pose& T_keyframe_frame_predicted,
                              Parallelism parallelism);

}  // namespace pcavr::tracking
