// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstdint>
#include <sstream>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/raw_bytes.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"

namespace pcavr {
namespace {

std::string repeated(const char* text, std::size_t count) {
  std::string line;
  for (std::size_t i = 0; i < count; ++i) line += text;
  return line;
}

std::string pcd_header(const PointCloud& cloud, std::size_t width, const Pose& T_cloud_sensor) {
  const bool has_normals = !cloud.normals.empty();
  const bool has_colors = !cloud.colors.empty();
  const std::size_t floats = has_normals ? 6 : 3;
  const std::size_t fields = floats + (has_colors ? 1 : 0);
  const std::size_t count = cloud.points.size();
  std::ostringstream text;
  text.precision(17);
  text << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z"
       << (has_normals ? " normal_x normal_y normal_z" : "") << (has_colors ? " rgb" : "")
       << "\nSIZE" << repeated(" 4", fields) << "\nTYPE" << repeated(" F", floats)
       << (has_colors ? " U" : "") << "\nCOUNT" << repeated(" 1", fields);
  const Eigen::Vector3d& p = T_cloud_sensor.translation();
  const Eigen::Quaterniond& q = T_cloud_sensor.rotation();
  text << "\nWIDTH " << (width > 0 ? width : count) << "\nHEIGHT "
       << (width > 0 ? count / width : 1) << "\nVIEWPOINT " << p.x() << ' ' << p.y() << ' ' << p.z()
       << ' ' << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << "\nPOINTS " << count
       << "\nDATA binary\n";
  return text.str();
}

void append_vector(std::string& bytes, const Eigen::Vector3f& vector) {
  for (const float number : vector) append_bytes(bytes, number);
}

}  // namespace

std::string format_pcd(const PointCloud& cloud, std::size_t width, const Pose& T_cloud_sensor) {
  PCAVR_REQUIRE(width == 0 || cloud.points.size() % width == 0, width, cloud.points.size());
  std::string bytes = pcd_header(cloud, width, T_cloud_sensor);
  bytes.reserve(bytes.size() + cloud.points.size() * 7 * sizeof(float));
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    append_vector(bytes, cloud.points[i]);
    if (!cloud.normals.empty()) append_vector(bytes, cloud.normals[i]);
    if (cloud.colors.empty()) continue;
    const Rgb8 color = cloud.colors[i];
    append_bytes(bytes, (std::uint32_t{color.r} << 16) | (std::uint32_t{color.g} << 8) | color.b);
  }
  return bytes;
}

}  // namespace pcavr
