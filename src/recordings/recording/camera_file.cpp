// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/camera_file.hpp"

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

#include "recordings/recording/camera_keys.hpp"
#include "recordings/recording/manifest_calibration.hpp"

namespace pcavr {
namespace {

/// No depth camera measures farther [m]: stereo with the longest baselines reaches a tenth of it.
constexpr double kMaxDepth = 1000.0;

DepthNoise read_noise(const YamlValue& noise) {
  noise.expect_keys({"constant", "quadratic", "offset", "grazing", "nearest", "farthest"});
  DepthNoise result;
  result.constant = noise.at("constant").positive_number();
  result.quadratic = noise.at("quadratic").number();
  result.offset = noise.at("offset").number();
  result.grazing = noise.at("grazing").number();
  result.min_depth = noise.at("nearest").positive_number();
  result.max_depth = noise.at("farthest").positive_number();
  if (result.max_depth <= result.min_depth) {
    noise.at("farthest").fail("is not greater than nearest", "write the farthest usable depth");
  }
  if (result.max_depth > kMaxDepth) {
    noise.at("farthest").fail("is more than 1000 m", "write the farthest usable depth in metres");
  }
  return result;
}

/// What `calibrate camera` writes.
CameraFile read_calibrated_camera(const YamlValue& root) {
  const YamlValue format = root.at("format");
  if (format.text() != kCalibrationFormat) {
    format.fail("is '" + format.text() + "'",
                std::string("this version reads ") + kCalibrationFormat);
  }
  const YamlValue kind = root.at("kind");
  if (kind.text() != "camera") {
    kind.fail("is '" + kind.text() + "'", "give what `pcavr calibrate camera` wrote");
  }
  CameraFile result;
  result.camera = camera_of(root.at("camera"));
  return result;
}

CameraFile read_pcavr_camera(const YamlValue& root) {
  root.expect_keys({"name", "source", "camera", "depth_scale", "depth_noise"});
  CameraFile result;
  if (const auto name = root.find("name")) result.name = name->text();
  const YamlValue camera = root.at("camera");
  camera.expect_keys({"width", "height", "fx", "fy", "cx", "cy", "model", "distortion"});
  result.camera = camera_of(camera);
  if (const auto scale = root.find("depth_scale")) result.depth_scale = scale->positive_number();
  if (const auto noise = root.find("depth_noise")) result.depth_noise = read_noise(*noise);
  return result;
}

/// ROS's names [REP 112 and image_geometry]; plumb_bob where the key is absent.
LensModel ros_model(const YamlValue& root) {
  const std::optional<YamlValue> model = root.find("distortion_model");
  if (!model) return LensModel::plumb_bob;
  const std::string name = model->text();
  if (name == "plumb_bob") return LensModel::plumb_bob;
  if (name == "rational_polynomial") return LensModel::rational;
  if (name == "equidistant") return LensModel::fisheye;
  model->fail("is '" + name + "'",
              "known are plumb_bob, rational_polynomial and equidistant; calibrate with one");
}

/// ROS's sensor_msgs/CameraInfo, as camera_calibration writes it.
CameraFile read_camera_info(const YamlValue& root) {
  const LensModel model = ros_model(root);
  CameraFile result;
  if (const auto name = root.find("camera_name")) result.name = name->text();
  const YamlValue matrix = root.at("camera_matrix").at("data");
  const std::vector<double> k = matrix.numbers(9);
  if (!(k[0] > 0.0) || !(k[4] > 0.0)) {
    matrix.fail("has a focal length that is not positive", "write fx 0 cx 0 fy cy 0 0 1");
  }
  result.camera = {.width = root.at("image_width").integer(1, kMaxImageSide),
                   .height = root.at("image_height").integer(1, kMaxImageSide),
                   .fx = k[0],
                   .fy = k[4],
                   .cx = k[2],
                   .cy = k[5]};
  CameraKeys keys{matrix, matrix, matrix, matrix};
  if (const auto coefficients = root.find("distortion_coefficients")) {
    keys.distortion = coefficients->at("data");
    result.camera.distortion = distortion_of(*keys.distortion, model);
  } else if (model != LensModel::plumb_bob) {
    (void)root.at("distortion_coefficients");
  }
  check_camera(result.camera, keys);
  return result;
}

}  // namespace

Expected<CameraFile> parse_camera_file(const std::string& text, const std::string& file) {
  return parse_yaml<CameraFile>(text, file, [](const YamlValue& root) {
    if (root.find("camera_matrix")) return read_camera_info(root);
    return root.find("format") ? read_calibrated_camera(root) : read_pcavr_camera(root);
  });
}

Expected<CameraFile> read_camera_file(const std::filesystem::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_camera_file(*text, file.string());
}

}  // namespace pcavr
