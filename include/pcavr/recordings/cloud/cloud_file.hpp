// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// One point cloud as a sensor recorded it, in the file's unit. `normals` and `colors` are empty or
/// as long as `points`.
struct RecordedCloud {
  /// Organised clouds have one point per pixel, row by row, and a height above 1; others have
  /// height 1.
  int width = 0;
  int height = 0;
  /// All coordinates are NaN where nothing was measured: not finite in the file, or exactly 0 0 0.
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< unit length in the file
  /// sRGB; intensities are grey, scaled by the smallest of 1, 255 and 65535 that none exceeds.
  std::vector<Rgb8> colors;
  /// Pose of the sensor in the cloud's frame: VIEWPOINT of a PCD, the camera of a PLY file.
  Pose T_cloud_sensor;

  [[nodiscard]] bool is_organised() const { return height > 1; }
  [[nodiscard]] std::size_t measured_points() const;
};

/// Parses a PCD file (0.5 to 0.7; ascii, binary or binary_compressed) or a PLY file (1.0; ascii or
/// binary of either byte order). Coordinates x y z may have any number type; colours are rgb, rgba
/// or red green blue, else intensity. Sizes that the header declares are checked against the bytes
/// before memory is allocated. Errors name `file` and, in headers and ascii data, the line. Safe
/// for untrusted bytes; thread-safe.
[[nodiscard]] Expected<RecordedCloud> parse_cloud(std::string_view bytes, const std::string& file);

/// Reads a file and parses it.
[[nodiscard]] Expected<RecordedCloud> read_cloud(const std::filesystem::path& file);

/// The bytes of a binary PCD file 0.7 with the fields that PCL expects: x y z, normal_x normal_y
/// normal_z and rgb where there are normals and colours. An organised cloud has `width` columns
/// (a divisor of the number of points); 0: not organised.
[[nodiscard]] std::string format_pcd(const PointCloud& cloud, std::size_t width = 0,
                                     const Pose& T_cloud_sensor = {});

}  // namespace pcavr
