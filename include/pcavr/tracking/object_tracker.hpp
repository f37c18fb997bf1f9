// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/marker/body_pose.hpp"
#include "pcavr/model/cad_model.hpp"
#include "pcavr/recording/frame_reader.hpp"

namespace pcavr {

struct ObjectTrackerOptions {
  DepthNoise depth_noise = {};
  double corner_sigma = 0.15;  ///< of a tag corner's coordinate [px]
  /// One standard deviation of an error that all depth readings of a body share, at a range of 1 m
  /// [m]; it grows with the square of the range, as an error of disparity does. What is left after
  /// a factory's calibration is 1 to 3 mm. Near 0, a biased sensor drags the tags' pose along.
  double depth_bias = 0.001;
  bool refine_with_depth = true;  ///< point to CAD surface, after the tags
  /// Rays cast at most for each pose that is tried, >= 100. With a deviation of 2 mm a ray, a face
  /// that has a quarter of 1500 is placed to 0.1 mm: finer than anything else in the chain.
  int max_samples = 1500;
};

/// What carried an object's pose in a frame.
enum class ObjectEvidence {
  tags_and_shape,
  tags,   ///< the depth explains too little of the CAD surface
  shape,  ///< no tag in view: the CAD surface against the depth alone
  none,   ///< lost: the pose is the last one known, and not to be used
};

struct ObjectObservation {
  Stamp stamp;  ///< of the depth image
  ObjectEvidence evidence = ObjectEvidence::none;
  Pose T_base_object;
  /// Of [v; w] in object axes. While shape alone carries the pose, directions that it does not
  /// show keep their last value, and their covariance grows from frame to frame.
  Matrix6d covariance = Matrix6d::Zero();
  int tags_used = 0;
  double refinement_translation = 0.0;  ///< by how much the depth moved the tags' pose [m]
  double refinement_rotation = 0.0;     ///< [rad]
  double surface_rms = 0.0;             ///< of depth along the ray against the CAD surface [m]
  double explained = 0.0;   ///< share of the depth on the body that lies on its surface, 0 to 1
  bool is_at_rest = false;  ///< has not moved for the last few observations
};

/// How far a camera pose may be off from one frame to another, one standard deviation. Zero for a
/// fixed camera, whose error is the same in all frames and looks like no motion.
struct CameraUncertainty {
  double position = 0.0;  ///< all axes together [m]
  double rotation = 0.0;  ///< [rad]
};

/// Follows one movable object through the frames: tags as a bundle, refined against the depth that
/// the CAD body explains; by shape alone while its tags are hidden. While the object rests, its
/// observations are averaged; when it moves, the average starts anew and each frame stands for
/// itself, so that nothing lags. Causal: an observation depends on earlier frames only. Not
/// thread-safe.
class ObjectTracker {
 public:
  ObjectTracker(CadModel model, std::vector<TagPlacement> tags, const CameraModel& camera,
                const ObjectTrackerOptions& options = {});
  ~ObjectTracker();
  ObjectTracker(ObjectTracker&&) noexcept;
  ObjectTracker& operator=(ObjectTracker&&) noexcept;

  [[nodiscard]] const CadModel& model() const;
  [[nodiscard]] const SurfaceQuery& surface() const;

  /// Frames in ascending order of time; depth as large as colour, or smaller by one factor.
  /// `T_base_camera` at the time of the depth image; the camera is taken to stand still between a
  /// frame's colour and depth.
  [[nodiscard]] ObjectObservation track(const RgbdFrame& frame,
                                        const std::vector<TagDetection>& detections,
                                        const Pose& T_base_camera,
                                        const CameraUncertainty& camera_uncertainty = {});

  /// Where nothing has been seen yet, shape alone may start from here.
  void set_initial_pose(const Pose& T_base_object);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Marks the pixels that show a body, or may: its silhouette grown by `margin_pixels`, wherever the
/// depth is not clearly (three deviations) in front of the body's surface. What is in front, such
/// as the tool, is not the body and stays; what is behind stays masked, because inside the
/// silhouette it contradicts the pose and at the rim it mixes body and background. Pixels without
/// depth in the grown silhouette are marked too. `camera` is the depth image's, and `mask`, which
/// is added to, has its size. Thin parts of a body may be missed where they are narrower than three
/// pixels.
void mask_body(const SurfaceQuery& surface_object, const Pose& T_camera_object,
               const CameraModel& camera, const DepthImage& depth, const DepthNoise& noise,
               int margin_pixels, MaskImage& mask);

}  // namespace pcavr
