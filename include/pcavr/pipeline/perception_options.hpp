// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Masks of movable bodies and of the tool; see src/pipeline/build/perception_options.cpp for
/// meanings, ranges and defaults.
struct MaskOptions {
  MaskOptions();

  int first_body_margin;  ///< [px]
  int body_margin;        ///< [px]
  int tool_margin;        ///< [px]
  double tip_margin;      ///< [m]
  double max_tool_gap;    ///< [s]
  double max_depth_step;  ///< [m]
  double min_tip_motion;  ///< [m]
  int min_tip_positions;
  double max_tip_distance;  ///< [m]
};

/// Checks of a recording's inputs against each other; see
/// src/pipeline/build/perception_options.cpp.
struct ConsistencyOptions {
  ConsistencyOptions();

  double warning_factor;
  double contradiction_factor;
  double tag_distance_error;       ///< [m]
  double max_body_size;            ///< [m]
  double tag_offset;               ///< [m]
  double warning_offset;           ///< [m]
  double contradiction_offset;     ///< [m]
  double warning_rotation;         ///< [rad]
  double contradiction_rotation;   ///< [rad]
  double warning_direction;        ///< [rad]
  double contradiction_direction;  ///< [rad]
};

/// The tip of an arm whose encoders are in front of elastic gears; see
/// src/pipeline/build/perception_options.cpp.
struct LoadedTipOptions {
  LoadedTipOptions();

  double gear_stiffness_std;  ///< relative
  double wind_up;             ///< [rad]
};

/// The options "tip_under_load".
[[nodiscard]] OptionSection section_of(LoadedTipOptions& options);

/// The options "masks" and "consistency".
[[nodiscard]] OptionSection section_of(MaskOptions& options);
[[nodiscard]] OptionSection section_of(ConsistencyOptions& options);

/// Options that building a scene and replaying a recording share: from images to poses.
/// `depth_noise` and `body_pose` apply to the trackers too, in place of the ones in `camera` and
/// `objects`.
struct PerceptionOptions {
  DepthNoise depth_noise = {};
  TagDetectorOptions tag_detector = {};
  BodyPoseOptions body_pose = {};
  CameraTrackerOptions camera = {};
  ObjectTrackerOptions objects = {};
  MaskOptions masks = {};
  ConsistencyOptions consistency = {};
  CadOptions cad = {};
  LoadedTipOptions loaded_tip = {};
};

/// The trackers' options with the common depth noise and body pose options.
[[nodiscard]] CameraTrackerOptions camera_options(const PerceptionOptions& options);
[[nodiscard]] ObjectTrackerOptions object_options(const PerceptionOptions& options);

/// All of them; they refer to `options`.
[[nodiscard]] std::vector<OptionSection> sections_of(PerceptionOptions& options);

}  // namespace pcavr
