// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/marker/body_pose.hpp"
#include "pcavr/recording/frame_reader.hpp"
#include "pcavr/recording/manifest.hpp"

namespace pcavr {

struct CameraTrackerOptions {
  DepthNoise depth_noise = {};
  double corner_sigma = 0.15;  ///< of a tag corner's coordinate [px]
  /// Take the poses of groundtruth.txt as given, instead of as measurements.
  bool trust_poses = false;
  double groundtruth_position_sigma = 0.005;  ///< weight of groundtruth.txt as a measurement [m]
  double groundtruth_rotation_sigma = 0.005;  ///< [rad]
  /// A camera that moved less than this over the whole recording is fixed: one pose for all.
  double fixed_camera_motion = 0.003;  ///< [m], at the tags and surfaces seen
};

enum class PlacementStatus {
  placed,
  lost,          ///< the frame matches neither its neighbours nor the model
  not_anchored,  ///< its stretch of the recording has no link to a base tag or to groundtruth
};

/// One frame's camera pose, and how far to trust it.
struct FramePlacement {
  std::size_t frame = 0;  ///< in Recording::frames
  Stamp stamp;            ///< of the depth image
  PlacementStatus status = PlacementStatus::lost;
  Pose T_base_camera;  ///< at `stamp`; meaningful where placed
  /// One standard deviation, all axes together [m], from the graph's covariance; infinite where
  /// that could not be had, and 0 where the pose was taken as given.
  double position_sigma = 0.0;
  double rotation_sigma = 0.0;  ///< likewise [rad]
  int base_tags = 0;            ///< seen in this frame and used
  /// By tracking alone, before tags and groundtruth.txt had a say: frames of one segment were
  /// aligned to each other. -1 where the frame was aligned to none.
  int segment = -1;
  Pose T_segment_camera;  ///< at `stamp`
};

struct CameraTrack {
  std::vector<FramePlacement> frames;  ///< every frame that was added, in order
  bool is_fixed_camera = false;
  double tag_reprojection_rms = 0.0;  ///< over the base corners used [px]; 0 without tags
  int tag_corners_used = 0;
  int tag_corners_rejected = 0;
  double tracking_rms = 0.0;  ///< point-to-plane, between frames and model [m]
  std::string why_not = {};   ///< where no frame could be placed: the reason, for a person
};

/// The camera's pose in base for every frame: dense RGB-D tracking bridges the frames between tag
/// sightings, and one pose graph over all frames is anchored by every base corner that was seen
/// (and by groundtruth.txt, where there is one). Frames are added in order; solve() once.
/// Memory grows with the keyframes, not with the frames. Not thread-safe.
class CameraTracker {
 public:
  /// `groundtruth` (T_base_camera) may be empty. Keeps no references. Throws ContractError unless
  /// the manifest has a camera and the sigmas are positive.
  CameraTracker(const Manifest& manifest, Trajectory groundtruth,
                const CameraTrackerOptions& options = {});
  ~CameraTracker();

  /// `is_dynamic` marks pixels that belong to movable objects or the tool (empty: none); they
  /// carry no weight; it has the depth image's size. Colour has the camera's size, depth the same
  /// or one that is smaller by one factor, equal in all frames. `detections` may hold other tags.
  void add(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
           const MaskImage& is_dynamic, Parallelism parallelism);

  /// Throws nothing; what can't be placed is said in the result.
  [[nodiscard]] CameraTrack solve(const Observer& observer = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
