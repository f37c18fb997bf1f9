// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

namespace pcavr {

/// The cloud of a frame in camera coordinates: organised with NaN where nothing was measured, or
/// the measured points alone in a random order.
inline PointCloud cloud_of_frame(const RgbdFrame& frame, const CameraModel& color_camera,
                                 bool is_organised) {
  const CameraModel camera = on_grid(color_camera, frame.depth.width(), frame.depth.height());
  PointCloud cloud;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const float z = frame.depth(u, v);
      Eigen::Vector3f point = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
      if (z > 0.0F) {
        point = camera.unproject({double(u), double(v)}, static_cast<double>(z)).cast<float>();
      } else if (!is_organised) {
        continue;
      }
      cloud.points.push_back(point);
      cloud.colors.push_back(frame.color(u, v));
    }
  }
  if (is_organised) return cloud;
  Random random(frame.index + 1);
  for (std::size_t i = cloud.points.size(); i > 1; --i) {
    const std::size_t j = random.below(i);
    std::swap(cloud.points[i - 1], cloud.points[j]);
    std::swap(cloud.colors[i - 1], cloud.colors[j]);
  }
  return cloud;
}

/// Writes each frame of a recording as DEPTH_STAMP.pcd into a folder that exists.
inline Expected<void> write_clouds(const Recording& recording, const std::filesystem::path& folder,
                                   bool is_organised) {
  FrameReader reader(recording);
  while (true) {
    const Expected<std::optional<RgbdFrame>> frame = reader.next();
    if (!frame) return frame.error();
    if (!*frame) return {};
    const PointCloud cloud = cloud_of_frame(**frame, *recording.manifest.camera, is_organised);
    const std::size_t width = is_organised ? static_cast<std::size_t>((*frame)->depth.width()) : 0;
    const auto written = write_file(folder / (format_stamp((*frame)->depth_stamp) + ".pcd"),
                                    format_pcd(cloud, width));
    if (!written) return written;
  }
}

}  // namespace pcavr
