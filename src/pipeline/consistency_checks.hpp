// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/model/cad_model.hpp"
#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/recording/manifest.hpp"
#include "pcavr/tracking/camera_tracker.hpp"

#include "consistency_observations.hpp"

namespace pcavr {

/// Frames that a finding needs: a misread tag or a bad alignment is seen in one or two.
inline constexpr std::size_t kMinFindingFrames = 3;

/// A length that an input states, held against what depth says it is.
struct ScaleRatio {
  enum class Kind {
    tag_size,       ///< of markers[first]
    tag_distance,   ///< of markers[first] and markers[second], on one body or in base
    camera_motion,  ///< of groundtruth.txt
  };
  Kind kind = Kind::tag_size;
  std::size_t first = 0;
  std::size_t second = 0;
  double stated = 0.0;     ///< [m]
  double by_depth = 0.0;   ///< [m], median
  double tolerance = 0.0;  ///< of the logarithm of their ratio
  std::size_t frames = 0;
};

/// The sizes of the tags seen, and the distances of those seen together.
[[nodiscard]] std::vector<ScaleRatio> tag_ratios(const Manifest& manifest,
                                                 const std::vector<TagSight>& sights,
                                                 std::size_t min_frames);

/// How far the camera went by groundtruth.txt, and by tracking the depth; nothing where it did not
/// go far enough to tell.
[[nodiscard]] std::optional<ScaleRatio> motion_ratio(const CameraTrack& track,
                                                     const Trajectory& groundtruth);

/// Which inputs explain the ratios that are off: the fewest that do. Where two explain them equally
/// well, the finding names both.
[[nodiscard]] std::vector<ConsistencyFinding> check_scales(const Manifest& manifest,
                                                           const std::vector<ScaleRatio>& ratios);

/// Focal lengths, by the shape that depth and image give the tags: a square stays one whatever its
/// size and whatever the unit of depth. Nothing where another input explains the tags as well.
[[nodiscard]] std::optional<ConsistencyFinding> check_focal_lengths(
    const Manifest& manifest, const std::vector<TagSight>& sights, std::size_t min_frames);

/// groundtruth.txt against tracking: rotations, and directions of motion. No unit plays a part.
[[nodiscard]] std::optional<ConsistencyFinding> check_camera_motion(const CameraTrack& track,
                                                                    const Trajectory& groundtruth);

/// groundtruth.txt against the base tags, where depth sees them.
[[nodiscard]] std::optional<ConsistencyFinding> check_camera_offset(
    const Manifest& manifest, const Trajectory& groundtruth, const std::vector<TagSight>& sights,
    const std::vector<Stamp>& depth_stamps, std::size_t min_frames);

/// A CAD body alone: size, density, and whether its tags lie on it.
[[nodiscard]] std::vector<ConsistencyFinding> check_body(const Manifest& manifest,
                                                         const ObjectEntry& entry,
                                                         const CadModel& model,
                                                         const SurfaceQuery& surface);

/// A CAD body against the depth in its outline.
[[nodiscard]] std::optional<ConsistencyFinding> check_outline(const Manifest& manifest,
                                                              const ObjectEntry& entry,
                                                              const OutlineFit& fit,
                                                              std::size_t min_frames);

/// Why a scene has no surface, as far as the frames say.
struct EmptySceneCause {
  std::string message;
  std::string hint;
};
/// Nearly all that was measured lies outside the sensor's range.
[[nodiscard]] bool is_out_of_range(const DepthSummary& depth);
struct CameraSteps {
  std::size_t frames_used = 0;
  double translation = 0.0;  ///< median between frames that follow each other [m]
  double rotation = 0.0;     ///< likewise [rad]
};
[[nodiscard]] EmptySceneCause explain_empty_scene(const DepthSummary& depth,
                                                  const DepthNoise& noise, double depth_scale,
                                                  const CameraSteps& camera, double min_weight);

}  // namespace pcavr
