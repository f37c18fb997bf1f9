// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recording/import_depth_scale.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "pcavr/core/output.hpp"
#include "pcavr/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// Images whose readings are compared: those of one may all show a wall at either range.
constexpr std::size_t kMaxImages = 8;
/// The format's scale needs this times as many readings in range: with less both are possible, and
/// what a user wrote counts.
constexpr double kMinScaleRatio = 2.0;

/// Of the readings, those within the sensor's range under each scale.
struct ReadingsInRange {
  double total = 0.0;
  double under_format = 0.0;
  double under_camera = 0.0;
};

ReadingsInRange count_readings(const std::vector<std::filesystem::path>& depth_files,
                               const CameraModel& camera, const DepthNoise& sensor,
                               double format_scale, double camera_scale) {
  ReadingsInRange readings;
  ImageDecoder decoder;
  const std::size_t stride = (depth_files.size() + kMaxImages - 1) / kMaxImages;
  for (std::size_t i = 0; i < depth_files.size(); i += stride) {
    const std::string name = depth_files[i].string();
    const Expected<std::string> bytes = read_file(name);
    if (!bytes) continue;
    const Expected<DepthImage> depth =
        decoder.depth(*bytes, {name, camera.width, camera.height}, format_scale);
    if (!depth) continue;
    for (const float z : depth->pixels()) {
      if (!(z > 0.0F)) continue;
      const auto is_in_range = [&](double distance) {
        return distance >= sensor.min_depth && distance <= sensor.max_depth;
      };
      ++readings.total;
      if (is_in_range(z)) ++readings.under_format;
      if (is_in_range(z * format_scale / camera_scale)) ++readings.under_camera;
    }
  }
  return readings;
}

}  // namespace

ImportedDepthScale choose_depth_scale(const std::vector<std::filesystem::path>& depth_files,
                                      const CameraModel& camera, ImportFormat format,
                                      const ImportOptions& options) {
  const double usual = usual_depth_scale(format);
  if (options.depth_scale) return {.used = *options.depth_scale};
  if (!options.camera_depth_scale || *options.camera_depth_scale == usual) return {.used = usual};
  ImportedDepthScale scale{.used = *options.camera_depth_scale, .other = usual};
  if (!options.depth_noise) return scale;
  const ReadingsInRange readings =
      count_readings(depth_files, camera, *options.depth_noise, usual, scale.used);
  if (readings.total == 0.0) return scale;
  scale.share_in_range = readings.under_camera / readings.total;
  scale.other_share_in_range = readings.under_format / readings.total;
  if (readings.under_format >= kMinScaleRatio * std::max(readings.under_camera, 1.0)) {
    std::swap(scale.used, *scale.other);
    std::swap(scale.share_in_range, scale.other_share_in_range);
  }
  return scale;
}

}  // namespace pcavr
