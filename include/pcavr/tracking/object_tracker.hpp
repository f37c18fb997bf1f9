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
  double corner_std = 0.15;  ///< of a tag corner's coordinate [px]
  /// Standard deviation of the depth bias common to all depth readings of a body, at a range of 1 m
  /// [m]; it grows with the square of the range, like a disparity error. Typically 1 to 3 mm remain
  /// after factory calibration. If set near 0, a biased sensor biases the pose.
  double depth_bias = 0.001;
  bool refine_with_depth = true;  ///< point-to-plane fit to the CAD surface, after the tags
  /// Maximum number of rays cast per iteration, >= 100. With a standard deviation of 2 mm per ray,
  /// a face with a quarter of 1500 rays is located to 0.1 mm: better than the other error sources.
  int max_samples = 1500;
};

/// Measurements that determined an object's pose in a frame.
enum class ObjectEvidence {
  tags_and_shape,
  tags,   ///< tags only: too few depth inliers on the CAD surface
  shape,  ///< no tag in view: CAD surface fitted to the depth alone
  none,   ///< lost: the pose is a prediction, not to be used
};

struct ObjectObservation {
  Stamp stamp;  ///< of the depth image
  ObjectEvidence evidence = ObjectEvidence::none;
  Pose T_base_object;
  /// Of the twist [v; w] in object axes. With shape alone, unobservable directions keep their last
  /// value, and their covariance grows from frame to frame.
  Matrix6d covariance = Matrix6d::Zero();
  int tags_used = 0;
  double refinement_translation = 0.0;  ///< correction of the tags' pose by depth [m]
  double refinement_rotation = 0.0;     ///< [rad]
  double surface_rms = 0.0;             ///< of depth residuals along the ray, inliers only [m]
  double inlier_ratio = 0.0;  ///< share of the depth on the body that lies on its surface, 0 to 1
  bool is_at_rest = false;    ///< has not moved for the last few observations
};

/// Standard deviation of the camera pose error from frame to frame. Zero for a fixed camera, whose
/// error is the same in all frames and causes no apparent motion.
struct CameraUncertainty {
  double position = 0.0;  ///< all axes combined [m]
  double rotation = 0.0;  ///< [rad]
};

/// Model-based tracking of one movable object: its tags as a bundle, refined by fitting the CAD
/// surface to the depth; by shape alone while its tags are occluded. While the object is at rest,
/// its measurements are averaged; when it moves, the average is reset and each frame is used alone,
/// so that there is no filter lag. Causal: an observation depends on earlier frames only. Not
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

  /// Frames in ascending order of time; depth of the size of colour, or downscaled by one factor.
  /// `T_base_camera` at the time of the depth image; the camera is assumed not to move between a
  /// frame's colour and depth images.
  [[nodiscard]] ObjectObservation track(const RgbdFrame& frame,
                                        const std::vector<TagDetection>& detections,
                                        const Pose& T_base_camera,
                                        const CameraUncertainty& camera_uncertainty = {});

  /// Initial guess for tracking by shape before any tag is detected.
  void set_initial_pose(const Pose& T_base_object);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Masks the pixels that may show a body: its silhouette dilated by `margin_pixels`, except where
/// the depth is more than three standard deviations in front of the body's surface (occluders such
/// as the tool). Depth behind the surface is masked too: inside the silhouette it contradicts the
/// pose, and at the contour it mixes body and background (flying pixels). So are pixels without
/// depth. `camera` is that of the depth image; `mask` has its size and keeps pixels already set.
/// Parts of a body narrower than three pixels may be missed.
void mask_body(const SurfaceQuery& surface_object, const Pose& T_camera_object,
               const CameraModel& camera, const DepthImage& depth, const DepthNoise& noise,
               int margin_pixels, MaskImage& mask);

}  // namespace pcavr
