// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

#include "declared_bodies.hpp"

namespace pcavr {

/// A body's first detection.
struct FirstDetection {
  std::size_t frame = 0;
  Pose T_camera_body;
};

/// Masks the pixels of movable bodies whose poses follow from a frame's tags, and stores each
/// body's first detection. Without masks, later poses are solved only in frames that need them.
class BodyMasker {
 public:
  /// Keeps references to `bodies` and `options`.
  BodyMasker(const std::vector<DeclaredBody>& bodies, const CameraModel& camera,
             const PerceptionOptions& options, bool with_masks);

  [[nodiscard]] const std::vector<std::optional<FirstDetection>>& first_detections() const {
    return first_detections_;
  }

  /// Repeats the first detections of the bodies with these tags by their other tags, in `seen`.
  void ignore_tags(const std::set<MarkerId>& ids,
                   const std::vector<std::vector<TagDetection>>& seen);

  /// The bodies' poses by the last frame's tags.
  [[nodiscard]] const std::vector<std::optional<Pose>>& last_poses() const { return last_poses_; }
  [[nodiscard]] const std::vector<SurfaceQuery>& surfaces() const { return surfaces_; }

  [[nodiscard]] MaskImage mask(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
                               bool needs_poses);

 private:
  const std::vector<DeclaredBody>& bodies_;
  CameraModel camera_;
  const PerceptionOptions& options_;
  bool with_masks_;
  std::vector<SurfaceQuery> surfaces_;
  std::vector<std::optional<Pose>> last_poses_;
  std::vector<std::optional<FirstDetection>> first_detections_;
};

}  // namespace pcavr
