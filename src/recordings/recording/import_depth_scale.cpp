// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording/import_depth_scale.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// Images whose readings are compared: those of one may all show a wall at either range.
constexpr std::size_t kMaxImages = 8;
/// Another scale than the stated or assumed one needs this times as many readings in range: with
/// less both are possible.
constexpr double kMinScaleRatio = 2.0;
constexpr double kMillimetres = 1000.0;  // [units/m]

/// Number of the readings, and of those within the sensor's range under each scale.
struct ReadingsInRange {
  double total = 0.0;
  double under_first = 0.0;
  double under_second = 0.0;
};

ReadingsInRange count_readings(const std::vector<std::filesystem::path>& depth_files,
                               const CameraModel& camera, const DepthNoise& sensor,
                               double first_scale, double second_scale) {
  ReadingsInRange readings;
  ImageDecoder decoder;
  const std::size_t stride = (depth_files.size() + kMaxImages - 1) / kMaxImages;
  for (std::size_t i = 0; i < depth_files.size(); i += stride) {
    const std::string name = depth_files[i].string();
    const Expected<std::string> bytes = read_file(name);
    if (!bytes) continue;
    const Expected<DepthImage> depth =
        decoder.depth(*bytes, {name, camera.width, camera.height}, first_scale);
    if (!depth) continue;
    for (const float z : depth->pixels()) {
      if (!(z > 0.0F)) continue;
      const auto is_in_range = [&](double distance) {
        return distance >= sensor.min_depth && distance <= sensor.max_depth;
      };
      ++readings.total;
      if (is_in_range(z)) ++readings.under_first;
      if (is_in_range(z * first_scale / second_scale)) ++readings.under_second;
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
  const double stated = options.camera_depth_scale.value_or(usual);
  const ImportedDepthScale by_statement = stated == usual
                                              ? ImportedDepthScale{.used = usual}
                                              : ImportedDepthScale{.used = stated, .other = usual};
  // Without a stated scale the layout's own is assumed, but many recorders write millimetres.
  const double other = options.camera_depth_scale ? usual : kMillimetres;
  const std::optional<DepthNoise> sensor =
      options.camera_depth_scale ? options.depth_noise : options.depth_noise.value_or(DepthNoise());
  if (other == stated || !sensor) return by_statement;
  const ReadingsInRange readings = count_readings(depth_files, camera, *sensor, stated, other);
  if (readings.total == 0.0) return by_statement;
  ImportedDepthScale scale = by_statement;
  scale.share_in_range = readings.under_first / readings.total;
  scale.other_share_in_range = readings.under_second / readings.total;
  if (readings.under_second >= kMinScaleRatio * std::max(readings.under_first, 1.0)) {
    scale = {other, stated, scale.other_share_in_range, scale.share_in_range};
  } else if (!scale.other) {
    return by_statement;
  }
  return scale;
}

}  // namespace pcavr
