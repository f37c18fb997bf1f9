// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recording/camera_file.hpp"

#include "pcavr/core/output.hpp"

#include "recording/camera_keys.hpp"
#include "recording/yaml_map.hpp"

namespace pcavr {
namespace {

DepthNoise read_noise(const YamlValue& noise) {
  noise.expect_keys({"constant", "quadratic", "offset", "grazing", "nearest", "farthest"});
  const DepthNoise result{.constant = noise.at("constant").positive_number(),
                          .quadratic = noise.at("quadratic").number(),
                          .offset = noise.at("offset").number(),
                          .grazing = noise.at("grazing").number(),
                          .nearest = noise.at("nearest").positive_number(),
                          .farthest = noise.at("farthest").positive_number()};
  if (result.farthest <= result.nearest) {
    noise.at("farthest").fail("is not greater than nearest", "write the farthest usable depth");
  }
  return result;
}

CameraFile read_own(const YamlValue& root) {
  root.expect_keys({"name", "source", "camera", "depth_scale", "depth_noise"});
  CameraFile result;
  if (const auto name = root.find("name")) result.name = name->text();
  const YamlValue camera = root.at("camera");
  camera.expect_keys({"width", "height", "fx", "fy", "cx", "cy", "distortion"});
  result.camera = camera_of(camera);
  if (const auto scale = root.find("depth_scale")) result.depth_scale = scale->positive_number();
  if (const auto noise = root.find("depth_noise")) result.depth_noise = read_noise(*noise);
  return result;
}

/// ROS's sensor_msgs/CameraInfo as camera_calibration writes it.
CameraFile read_camera_info(const YamlValue& root) {
  if (const auto model = root.find("distortion_model"); model && model->text() != "plumb_bob") {
    model->fail("is '" + model->text() + "'", "only plumb_bob is known; calibrate with it");
  }
  CameraFile result;
  if (const auto name = root.find("camera_name")) result.name = name->text();
  const YamlValue matrix = root.at("camera_matrix").at("data");
  const std::vector<double> k = matrix.numbers(9);
  if (!(k[0] > 0.0) || !(k[4] > 0.0)) {
    matrix.fail("has a focal length that is not more than 0", "write fx 0 cx 0 fy cy 0 0 1");
  }
  result.camera = {.width = root.at("image_width").integer(1, kLargestImageSide),
                   .height = root.at("image_height").integer(1, kLargestImageSide),
                   .fx = k[0],
                   .fy = k[4],
                   .cx = k[2],
                   .cy = k[5]};
  if (const auto coefficients = root.find("distortion_coefficients")) {
    result.camera.distortion = distortion_of(coefficients->at("data"));
  }
  return result;
}

}  // namespace

Expected<CameraFile> parse_camera_file(const std::string& text, const std::string& file) {
  return parse_yaml<CameraFile>(text, file, [](const YamlValue& root) {
    return root.find("camera_matrix") ? read_camera_info(root) : read_own(root);
  });
}

Expected<CameraFile> read_camera_file(const std::filesystem::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_camera_file(*text, file.string());
}

}  // namespace pcavr
