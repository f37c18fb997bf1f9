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
  double corner_sigma = 0.15;     ///< of a tag corner's coordinate [px]
  bool refine_with_depth = true;  ///< point to CAD surface, after the tags
};

/// What carried an object's pose in a frame.
enum class ObjectEvidence {
  tags_and_shape,
  tags,   ///< the depth explains too little of the CAD surface
  shape,  ///< no tag in view: the CAD surface against the depth alone
  none,   ///< lost: the pose is not to be used
};

struct ObjectObservation {
  Stamp stamp;  ///< of the depth image
  ObjectEvidence evidence = ObjectEvidence::none;
  Pose T_base_object;
  Matrix6d covariance = Matrix6d::Zero();  ///< of [v; w] in object axes
  int tags_used = 0;
  double refinement_translation = 0.0;  ///< by how much the depth moved the tags' pose [m]
  double refinement_rotation = 0.0;     ///< [rad]
  double surface_rms = 0.0;             ///< point to CAD surface [m]
  bool is_at_rest = false;              ///< has not moved since the last observation
};

/// Follows one movable object through the frames: tags as a bundle, refined against the depth that
/// the CAD body explains; by shape alone while its tags are hidden. While the object rests, its
/// observations are averaged; when it moves, the average starts anew. Not thread-safe.
class ObjectTracker {
 public:
  ObjectTracker(CadModel model, std::vector<TagPlacement> tags, const CameraModel& camera,
                const ObjectTrackerOptions& options = {});
  ~ObjectTracker();
  ObjectTracker(ObjectTracker&&) noexcept;

  [[nodiscard]] const CadModel& model() const;
  [[nodiscard]] const SurfaceQuery& surface() const;

  /// Frames in ascending order of time.
  [[nodiscard]] ObjectObservation track(const RgbdFrame& frame,
                                        const std::vector<TagDetection>& detections,
                                        const Pose& T_base_camera);

  /// Where nothing has been seen yet, shape alone may start from here.
  void set_initial_pose(const Pose& T_base_object);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Marks the pixels that may show a body: its silhouette grown by `margin_pixels`, and in depth
/// from `margin(z)` in front of its surface on. Adds to `mask`, which has the camera's size.
void mask_body(const SurfaceQuery& surface_object, const Pose& T_camera_object,
               const CameraModel& camera, const DepthImage& depth, const DepthNoise& noise,
               int margin_pixels, MaskImage& mask);

}  // namespace pcavr
