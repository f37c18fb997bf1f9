// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Whether an object is at rest; see src/perception/tracking/object_options.cpp for meanings and
/// defaults.
struct RestOptions {
  RestOptions();

  int min_count;
  int max_averaged;
  double translation_floor_std;  ///< [m]
  double rotation_floor_std;     ///< [rad]
};

/// See src/perception/tracking/object_options.cpp for meanings, ranges and defaults.
struct ObjectTrackerOptions {
  ObjectTrackerOptions();

  DepthNoise depth_noise;
  BodyPoseOptions body_pose;
  RestOptions rest;
  bool refine_with_depth;
  int max_samples;
  double depth_bias;                ///< [m]
  double depth_correlation_length;  ///< [px]
  double contour_std;               ///< [px]
  double max_tag_residual;          ///< [px]
  double max_corner_shift;          ///< [std]
  double capture_range;             ///< [m]
  int min_inliers;
  double min_inlier_ratio_with_tags;
  double min_inlier_ratio_shape_only;
  double max_behind_ratio;
  double max_normalised_rms;
  double acceleration_std;          ///< [m/s^2]
  double angular_acceleration_std;  ///< [rad/s^2]
  double max_prediction_time;       ///< [s]
  double initial_translation_std;   ///< [m]
  double initial_rotation_std;      ///< [rad]
  double velocity_decay;
};

/// The options "tracking.rest" and "tracking.objects".
[[nodiscard]] OptionSection section_of(RestOptions& options);
[[nodiscard]] OptionSection section_of(ObjectTrackerOptions& options);

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
  /// Covariance of the twist [v; w] in object axes. With shape alone, unobservable directions keep
  /// their last value, and their covariance grows from frame to frame.
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
