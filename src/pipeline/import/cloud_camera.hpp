// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/pipeline/import_clouds.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"
#include "pcavr/recordings/cloud/cloud_list.hpp"
#include "pcavr/recordings/cloud/pinhole_fit.hpp"

namespace pcavr {

/// A cloud in metres.
struct MetricCloud {
  RecordedCloud cloud;
  std::size_t points = 0;  ///< measured
};

/// Scales a cloud to metres. One without a measured point is an Error that names the file.
[[nodiscard]] Expected<MetricCloud> to_metres(RecordedCloud cloud, double unit,
                                              const std::string& file);

/// The conversion of a sequence's clouds to images, decided from some of them.
struct CloudCamera {
  bool is_organised = false;
  double unit = 1.0;             ///< [m]
  bool is_unit_guessed = false;  ///< millimetres were detected
  double median_range = 0.0;     ///< of the points from the sensor [m]
  /// The points are in sensor coordinates, whatever the viewpoint says of the sensor's pose.
  bool is_in_sensor_frame = true;
  PinholeFit pinhole;  ///< of organised clouds; the camera, without residuals, of others
  std::vector<Pose> T_sensor_camera;
  double ray_spacing = 0.0;
  bool has_viewpoints = false;  ///< the viewpoints are the poses of the sensor
};

/// Reads some clouds of the list, and decides.
[[nodiscard]] Expected<CloudCamera> choose_cloud_camera(const std::vector<ListedCloud>& clouds,
                                                        const CloudImportOptions& options);

/// Depth and colour of one cloud in one camera.
struct CloudFrame {
  Pose T_cloud_camera;
  DepthImage depth;
  ColorImage color;
};

struct ConvertedCloud {
  std::vector<CloudFrame> frames;
  Pose T_cloud_sensor;                         ///< the viewpoint
  std::vector<Eigen::Vector3f> thinned_cloud;  ///< in the cloud's frame; where asked for
  std::size_t points = 0;
  std::size_t points_used = 0;
  double residual = 0.0;  ///< of the pinhole projection, rms [px]
};

/// Converts one cloud; `thin_voxel` > 0 asks for its thinned points [m]. An Error names `file`
/// where the cloud differs in kind or size from those that the camera was chosen from. Thread-safe.
[[nodiscard]] Expected<ConvertedCloud> convert_cloud(RecordedCloud cloud, const std::string& file,
                                                     const CloudCamera& camera, double thin_voxel);

}  // namespace pcavr
