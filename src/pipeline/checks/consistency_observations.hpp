// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

namespace pcavr {

/// A tag measured in one frame by its corners in the image and the depth inside it, without using
/// its stated size.
struct TagMeasurement {
  std::size_t frame = 0;   ///< in Recording::frames
  std::size_t marker = 0;  ///< in Manifest::markers
  /// Corners in camera coordinates, in the order of TagDetection::corners [m].
  std::array<Eigen::Vector3d, 4> corners_camera;

  [[nodiscard]] Eigen::Vector3d centre_camera() const;
};

/// Measures a tag's corners by image and depth; nothing where too little depth was measured inside.
[[nodiscard]] std::optional<TagMeasurement> measure_tag(const DepthImage& depth,
                                                        const CameraModel& camera,
                                                        const TagDetection& detection);

/// Scales of a CAD body that are compared with the depth. The factors are 1 / 1.5
/// apart at the ends, and finer in the range of warnings.
inline constexpr std::array<double, 7> kOutlineScales = {0.5, 1.0 / 1.5, 0.8, 1.0, 1.25, 1.5, 2.0};
inline constexpr std::size_t kUnscaled = 3;  ///< index of 1 above

/// Agreement of a CAD body, scaled about its frame's origin, with the depth in its outline
/// (silhouette).
struct OutlineFit {
  std::size_t frames = 0;
  /// Number of pixels with depth on the body, minus those with depth behind it, by scale.
  std::array<double, kOutlineScales.size()> score{};
  std::array<double, kOutlineScales.size()> explained{};  ///< pixels
  std::array<double, kOutlineScales.size()> outline{};    ///< pixels with depth
  /// Where the depth has the body, in its own axes, relative to where its tags put it [m]: one for
  /// each frame, zero where it fits there.
  std::vector<Eigen::Vector3d> shifts = {};

  /// Median of the shifts; zero without frames.
  [[nodiscard]] Eigen::Vector3d shift() const;
};

/// Adds one frame to the fit.
void add_outline(const SurfaceQuery& surface_object, const Pose& T_camera_object,
                 const CameraModel& camera, const DepthImage& depth, const DepthNoise& noise,
                 OutlineFit& fit);

/// Statistics of the depth in a recording's frames.
struct DepthSummary {
  std::size_t frames = 0;
  std::size_t pixels = 0;            ///< sampled: a subset of each image
  std::size_t measured = 0;          ///< of these, not 0
  std::size_t in_range = 0;          ///< of these, within the sensor's range
  std::vector<double> medians = {};  ///< of each frame with any measurement [m]

  void add(const DepthImage& depth, const DepthNoise& noise);
};

/// Measurements in the frames that check the inputs' scale.
struct ConsistencyObservations {
  std::vector<TagMeasurement> tags;  ///< by frame
  std::vector<OutlineFit> outlines;  ///< by movable body
  DepthSummary depth;
};

/// Collects them, frame by frame. Keeps references to the constructor's arguments.
class ConsistencyCollector {
 public:
  /// `surfaces_object` are the movable bodies'; `frames` is the maximum number of frames.
  ConsistencyCollector(const Manifest& manifest, const DepthNoise& noise,
                       const std::vector<SurfaceQuery>& surfaces_object, std::size_t frames);

  /// Whether the next add() uses the bodies' poses: a subset of the frames is enough for their
  /// outlines.
  [[nodiscard]] bool needs_body_poses_next() const { return frames_seen_ % outline_stride_ == 0; }

  /// `T_camera_body` has an item for each body, empty where its tags give no pose.
  void add(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
           const std::vector<std::optional<Pose>>& T_camera_body);

  /// Removes what was measured of these tags, and in the outlines of these bodies (indices), whose
  /// poses are by such tags.
  void ignore_tags(const std::set<MarkerId>& ids, const std::vector<std::size_t>& bodies);

  [[nodiscard]] const ConsistencyObservations& observations() const { return observations_; }

 private:
  const Manifest& manifest_;
  const DepthNoise& noise_;
  const std::vector<SurfaceQuery>& surfaces_object_;
  std::size_t outline_stride_;
  std::size_t frames_seen_ = 0;
  ConsistencyObservations observations_;
};

}  // namespace pcavr
