// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/cdr_camera_info.hpp"

#include <initializer_list>
#include <span>

#include "cdr_writer.hpp"

namespace pcavr::cdr {
namespace {

constexpr std::string_view kCameraInfo =
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
    "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
    "sensor_msgs/RegionOfInterest roi\n";
constexpr std::string_view kRegion =
    "MSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\n"
    "uint32 width\nbool do_rectify\n";

/// As ROS names them.
std::string_view name_of_lens(LensModel model) {
  switch (model) {
    case LensModel::rational:
      return "rational_polynomial";
    case LensModel::fisheye:
      return "equidistant";
    case LensModel::plumb_bob:
      break;
  }
  return "plumb_bob";
}

}  // namespace

std::string camera_info_definition() { return definition(kCameraInfo, {kHeader, kTime, kRegion}); }

std::vector<std::uint8_t> camera_info(Stamp stamp, std::string_view frame,
                                      const CameraModel& camera) {
  Writer writer;
  writer.header(stamp, frame);
  writer.u32(static_cast<std::uint32_t>(camera.height));
  writer.u32(static_cast<std::uint32_t>(camera.width));
  writer.text(name_of_lens(camera.distortion.model()));
  const std::span<const double> coefficients = camera.distortion.coefficients();
  writer.count(coefficients.size());
  for (const double coefficient : coefficients) writer.f64(coefficient);
  const auto write = [&](std::initializer_list<double> values) {
    for (const double value : values) writer.f64(value);
  };
  write({camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
  write({1, 0, 0, 0, 1, 0, 0, 0, 1});
  write({camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0});
  for (int i = 0; i < 6; ++i) writer.u32(0);  // binning, and a region of interest that is the image
  writer.u8(0);                               // do_rectify
  return writer.take();
}

}  // namespace pcavr::cdr
