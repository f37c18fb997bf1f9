// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

#include "consistency_observations.hpp"

namespace pcavr {

/// Frames that a finding needs: a misread tag or a bad alignment occurs in one or two.
inline constexpr std::size_t kMinFindingFrames = 3;

/// A length that an input states, and the same length measured by depth.
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
                                                 const std::vector<TagMeasurement>& measurements,
                                                 std::size_t min_frames,
                                                 const ConsistencyOptions& options = {});

/// The camera's path length by groundtruth.txt and by tracking the depth; nothing where the path is
/// too short.
[[nodiscard]] std::optional<ScaleRatio> motion_ratio(const CameraTrack& track,
                                                     const Trajectory& groundtruth,
                                                     const ConsistencyOptions& options = {});

/// The smallest set of wrong inputs that explains the ratios that are off. Where two explain them
/// equally well, the finding names both.
[[nodiscard]] std::vector<ConsistencyFinding> check_scales(const Manifest& manifest,
                                                           const std::vector<ScaleRatio>& ratios,
                                                           const ConsistencyOptions& options = {});

/// Focal lengths, by the shape of the tags measured by depth and image: a square remains a square
/// for any size and any unit of depth. Nothing where another input explains the tags as well.
[[nodiscard]] std::optional<ConsistencyFinding> check_focal_lengths(
    const Manifest& manifest, const std::vector<TagMeasurement>& measurements,
    std::size_t min_frames, const ConsistencyOptions& options = {});

/// Principal point and distortion, by the distances of base tags' corners, measured by depth and
/// image: their errors shear and bend what is measured, as no unit of depth does. Nothing where the
/// tags' stated poses explain the distances as well.
[[nodiscard]] std::optional<ConsistencyFinding> check_principal_point(
    const Manifest& manifest, const std::vector<TagMeasurement>& measurements,
    std::size_t min_frames, const ConsistencyOptions& options = {});

/// groundtruth.txt against tracking: rotations and directions of motion, independent of units.
[[nodiscard]] std::optional<ConsistencyFinding> check_camera_motion(
    const CameraTrack& track, const Trajectory& groundtruth,
    const ConsistencyOptions& options = {});

/// groundtruth.txt against the base tags, as measured by depth.
[[nodiscard]] std::optional<ConsistencyFinding> check_camera_offset(
    const Manifest& manifest, const Trajectory& groundtruth,
    const std::vector<TagMeasurement>& measurements, const std::vector<Stamp>& depth_stamps,
    std::size_t min_frames, const ConsistencyOptions& options = {});

/// A CAD body alone: size, density, and whether its tags lie on it.
[[nodiscard]] std::vector<ConsistencyFinding> check_body(const Manifest& manifest,
                                                         const ObjectEntry& entry,
                                                         const CadModel& model,
                                                         const SurfaceQuery& surface,
                                                         const ConsistencyOptions& options = {});

/// A CAD body against the depth in its outline.
[[nodiscard]] std::optional<ConsistencyFinding> check_outline(
    const Manifest& manifest, const ObjectEntry& entry, const OutlineFit& fit,
    std::size_t min_frames, const ConsistencyOptions& options = {});

/// A CAD body that the depth shows elsewhere than its tags have it.
[[nodiscard]] std::optional<ConsistencyFinding> check_place(const Manifest& manifest,
                                                            const ObjectEntry& entry,
                                                            const OutlineFit& fit,
                                                            std::size_t min_frames);

/// The probable cause of a scene without a surface.
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
