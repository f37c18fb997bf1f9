// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

struct CloudImportOptions {
  /// TUM trajectory of the clouds' frame in base, or in a world frame (see anchor_by_tags and
  /// T_base_world). Empty: VIEWPOINT of the clouds where they differ, else the clouds are aligned
  /// with each other, and the world frame is that of the first cloud.
  std::filesystem::path poses = {};
  /// A recording.yaml of which markers, objects, tool and robot are taken over, with their files.
  std::filesystem::path manifest = {};
  std::optional<Pose> T_base_world = {};
  /// Finds T_base_world from the manifest's base tags in the clouds' colours. Without poses this
  /// is done whenever the manifest has base tags.
  bool anchor_by_tags = false;
  /// Length of one coordinate unit [m]; detected (1 or 0.001) where not given.
  std::optional<double> unit = {};
  bool as_unorganised = false;  ///< ignore the grid of organised clouds
  double depth_scale = 5000.0;  ///< of the images written [units/m]
  double frame_rate = 30.0;     ///< [Hz], 0.1 to 1e5, for clouds with frame numbers
  std::size_t stride = 1;       ///< take every n-th cloud
  std::size_t first = 0;        ///< skip the clouds before this one
  Parallelism parallelism = Parallelism::max();
};

/// Source of the clouds' poses.
enum class CloudPoses { given, viewpoints, aligned };

struct CloudImportReport {
  std::size_t clouds = 0;
  std::size_t frames = 0;  ///< images; several for each cloud of a wide field of view
  bool is_organised = false;
  CameraModel camera;
  double pinhole_residual = 0.0;   ///< of organised clouds: largest rms of a cloud [px]
  double ray_spacing = 0.0;        ///< of unorganised clouds, median [rad]
  double unit = 1.0;               ///< [m]
  std::size_t points = 0;          ///< measured
  std::size_t points_outside = 0;  ///< of the virtual camera, or hidden; left out
  CloudPoses poses = CloudPoses::given;
  double alignment_rms = 0.0;        ///< between aligned clouds [m]
  double alignment_overlap = 0.0;    ///< least share of an aligned cloud
  std::size_t anchor_frames = 0;     ///< frames with base tags that gave T_base_world; 0: none
  double anchor_position_rms = 0.0;  ///< between tags and poses in these [m]
  double anchor_rotation_rms = 0.0;  ///< [rad]
};

/// Converts a sequence of point clouds (cloud/cloud_list.hpp) to a recording at `target`, an
/// existing, empty folder. Organised clouds become depth and colour images of the camera that is
/// estimated from their points, so that tags are found in them; a cloud that is no pinhole
/// projection is an Error. Unorganised clouds become range images by the rays from their viewpoint
/// (cloud/range_image.hpp), one for each face of a cube where the field of view is wide. A cloud's
/// pose, in base, is written to `groundtruth.txt`. Errors name the file; the caller removes what
/// was written. Deterministic for any parallelism; memory holds a few clouds at a time.
[[nodiscard]] Expected<CloudImportReport> import_clouds(const std::filesystem::path& source,
                                                        const std::filesystem::path& target,
                                                        const CloudImportOptions& options,
                                                        const Observer& observer = {});

}  // namespace pcavr
