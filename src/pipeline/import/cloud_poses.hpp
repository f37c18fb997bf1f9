// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/recordings/cloud/cloud_list.hpp"

#include "cloud_camera.hpp"

namespace pcavr {

/// The pose of each cloud by a TUM file: those at the clouds' stamps (interpolated), or where the
/// stamps are of different clocks and there are as many poses as clouds, one after the other.
/// `selected` are indices in the list. An Error where neither holds.
[[nodiscard]] Expected<std::vector<Pose>> read_cloud_poses(
    const std::filesystem::path& file, const CloudList& list,
    const std::vector<std::size_t>& selected);

/// T_base_world from base tags that the clouds show.
struct TagAnchor {
  Pose T_base_world;
  std::size_t frames = 0;
  double position_rms = 0.0;  ///< of the cameras by tags and by poses [m]
  double rotation_rms = 0.0;  ///< [rad]
};

/// Collects a sequence's camera poses by the base tags.
class TagAnchorCollector {
 public:
  /// An Error for an unknown family.
  [[nodiscard]] static Expected<TagAnchorCollector> create(const Manifest& manifest,
                                                           const CameraModel& camera);

  /// `frame`: index by which solve() finds the frame's pose in the world frame.
  void add(std::size_t frame, const ColorImage& color, const DepthImage& depth);

  /// The rotation is the mean of the frames' (chordal), the translation that of the cameras'
  /// positions; frames further from it than three times the median are left out. nullopt where no
  /// frame has a pose by tags.
  [[nodiscard]] std::optional<TagAnchor> solve(const std::vector<Pose>& T_world_camera) const;

 private:
  TagAnchorCollector(TagDetector detector, std::vector<TagPlacement> placements,
                     const CameraModel& camera)
      : detector_(std::move(detector)), placements_(std::move(placements)), camera_(camera) {}

  struct Observation {
    std::size_t frame;
    Pose T_base_camera;
  };
  TagDetector detector_;
  std::vector<TagPlacement> placements_;
  CameraModel camera_;
  std::vector<Observation> observations_;
};

}  // namespace pcavr
