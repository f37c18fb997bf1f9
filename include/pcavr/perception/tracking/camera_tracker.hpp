// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/perception/tracking/camera_options.cpp for meanings, ranges and defaults.
struct CameraTrackerOptions {
  CameraTrackerOptions();

  DepthNoise depth_noise;
  BodyPoseOptions body_pose;
  bool trust_poses = false;         ///< use groundtruth.txt as exact, not as measurements
  bool states_pose_stds = false;    ///< the next two hold for all poses (stated_poses.hpp)
  double groundtruth_position_std;  ///< [m]
  double groundtruth_rotation_std;  ///< [rad]
  double max_fixed_camera_motion;   ///< [m]
  double keyframe_baseline;         ///< of the mean depth
  double keyframe_angle;            ///< [rad]
  double keyframe_overlap;
  double keyframe_landmark_ratio;
  double max_prediction_time;  ///< [s]
  double min_inlier_ratio;
  double min_correlation;
  double max_contradicted;
  int min_features;
  double max_position_std;            ///< [m]
  double max_rotation_std;            ///< [rad]
  double corner_rejection_threshold;  ///< [std]
};

/// The options "tracking.camera".
[[nodiscard]] OptionSection section_of(CameraTrackerOptions& options);

enum class PlacementStatus {
  placed,
  lost,  ///< tracking lost: the frame matches neither its neighbours nor the model
  /// Tracked, but its segment is not linked to a base tag or to groundtruth, or not well enough: to
  /// more than half a metre or 20 degrees (std).
  not_anchored,
};

/// Estimated camera pose of one frame, with its standard deviation.
struct FramePlacement {
  std::size_t frame = 0;  ///< in Recording::frames
  Stamp stamp;            ///< of the depth image
  PlacementStatus status = PlacementStatus::lost;
  Pose T_base_camera;  ///< at `stamp`; valid if `placed`
  /// Standard deviation, all axes combined [m], from the pose graph's covariance; infinite if that
  /// could not be computed, and 0 if the pose was given as exact.
  double position_std = 0.0;
  double rotation_std = 0.0;  ///< likewise [rad]
  int base_tags = 0;          ///< number of base tags used in this frame
  /// From tracking alone, before tags and groundtruth.txt are used: the frames of one segment are
  /// aligned to each other. -1 if the frame was not aligned to any.
  int segment = -1;
  Pose T_segment_camera;  ///< at `stamp`
};

struct CameraTrack {
  std::vector<FramePlacement> frames;  ///< every frame that was added, in order
  bool is_fixed_camera = false;
  double tag_reprojection_rms = 0.0;  ///< over the base corners used [px]; 0 without tags
  int tag_corners_used = 0;
  int tag_corners_rejected = 0;
  /// Alignments that contradict the given poses of their frames, and are not used.
  std::size_t links_rejected = 0;
  double tracking_rms = 0.0;        ///< point-to-plane, between frames and model [m]
  std::string failure_reason = {};  ///< if no frame was placed: a message for the user
};

/// Estimates the camera's pose in base for every frame (RGB-D SLAM): dense RGB-D tracking bridges
/// the frames between tag detections, and one pose graph over all frames, with loop closures, is
/// anchored by all detected base tag corners (and by groundtruth.txt, if there is one). Frames are
/// added in order; call solve() once. Memory grows with the keyframes, not with the frames. Not
/// thread-safe.
class CameraTracker {
 public:
  /// `groundtruth` (T_base_camera) may be empty. Keeps no references. Throws ContractError unless
  /// the manifest has a camera and the standard deviations are positive.
  CameraTracker(const Manifest& manifest, Trajectory groundtruth,
                const CameraTrackerOptions& options = {});
  ~CameraTracker();

  /// `is_dynamic` masks pixels of movable objects or the tool (empty: none), which are ignored; it
  /// has the depth image's size. Colour has the camera's size; depth has the same size or is
  /// downscaled by one factor, equal in all frames. `detections` may include other tags.
  void add(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
           const MaskImage& is_dynamic, Parallelism parallelism);

  /// Removes these tags from all frames added before: what they showed is not used. Call before
  /// solve().
  void ignore_tags(const std::set<MarkerId>& ids);

  /// Does not throw; frames without a pose are marked in the result.
  [[nodiscard]] CameraTrack solve(const Observer& observer = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
