// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recording/camera_file.hpp"

#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "pcavr/core/output.hpp"

namespace pcavr {
namespace {

/// Stops the reading at the first fault; never leaves this file.
struct Fault {
  Error error;
};

class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  [[noreturn]] void fail(const YAML::Node& node, const std::string& key, std::string message,
                         std::string mend = {}) const {
    throw Fault{{.message = std::move(message),
                 .file = file_,
                 .line = node.Mark().line + 1,
                 .place = key,
                 .mend = std::move(mend)}};
  }

  [[nodiscard]] YAML::Node require(const YAML::Node& map, const std::string& key) const {
    const YAML::Node node = map[key];
    if (!node) fail(map, key, "is missing", "add it");
    return node;
  }

  [[nodiscard]] double number(const YAML::Node& map, const std::string& key) const {
    const YAML::Node node = require(map, key);
    double value = 0.0;
    if (!YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
      fail(node, key, "is not a finite number");
    }
    return value;
  }

  [[nodiscard]] double positive(const YAML::Node& map, const std::string& key) const {
    const double value = number(map, key);
    if (value <= 0.0) fail(map[key], key, "must be greater than 0");
    return value;
  }

  [[nodiscard]] int pixels(const YAML::Node& map, const std::string& key) const {
    const double value = positive(map, key);
    if (value != std::floor(value) || value > 20000) fail(map[key], key, "is no image size");
    return static_cast<int>(value);
  }

  [[nodiscard]] std::array<double, 5> distortion(const YAML::Node& list,
                                                 const std::string& key) const {
    std::array<double, 5> values{};
    if (!list.IsSequence() || list.size() > values.size()) {
      fail(list, key, "must list at most five numbers: k1 k2 p1 p2 k3");
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!YAML::convert<double>::decode(list[i], values[i]) || !std::isfinite(values[i])) {
        fail(list[i], key, "is not a finite number");
      }
    }
    return values;
  }

  void only_keys(const YAML::Node& map, const std::set<std::string>& known) const {
    if (!map.IsMap()) fail(map, "", "must be a map of keys");
    for (const auto& entry : map) {
      const std::string key = entry.first.as<std::string>("");
      if (known.count(key) == 0) fail(entry.first, key, "is not a known key", "remove it");
    }
  }

 private:
  std::string file_;
};

CameraFile read_own(const Reader& reader, const YAML::Node& root) {
  reader.only_keys(root, {"name", "source", "camera", "depth_scale", "depth_noise"});
  CameraFile result{.name = root["name"].as<std::string>(""), .camera = {}};
  const YAML::Node camera = reader.require(root, "camera");
  reader.only_keys(camera, {"width", "height", "fx", "fy", "cx", "cy", "distortion"});
  result.camera = {.width = reader.pixels(camera, "width"),
                   .height = reader.pixels(camera, "height"),
                   .fx = reader.positive(camera, "fx"),
                   .fy = reader.positive(camera, "fy"),
                   .cx = reader.number(camera, "cx"),
                   .cy = reader.number(camera, "cy")};
  if (const YAML::Node list = camera["distortion"]) {
    result.camera.distortion = reader.distortion(list, "distortion");
  }
  if (root["depth_scale"]) result.depth_scale = reader.positive(root, "depth_scale");
  if (const YAML::Node noise = root["depth_noise"]) {
    reader.only_keys(noise, {"constant", "quadratic", "offset", "grazing", "nearest", "farthest"});
    result.depth_noise = DepthNoise{.constant = reader.positive(noise, "constant"),
                                    .quadratic = reader.number(noise, "quadratic"),
                                    .offset = reader.number(noise, "offset"),
                                    .grazing = reader.number(noise, "grazing"),
                                    .nearest = reader.positive(noise, "nearest"),
                                    .farthest = reader.positive(noise, "farthest")};
    if (result.depth_noise->farthest <= result.depth_noise->nearest) {
      reader.fail(noise, "farthest", "must be greater than nearest");
    }
  }
  return result;
}

CameraFile read_camera_info(const Reader& reader, const YAML::Node& root) {
  const YAML::Node model = root["distortion_model"];
  const std::string name = model ? model.as<std::string>("") : "plumb_bob";
  if (name != "plumb_bob") {
    reader.fail(model, "distortion_model", "is '" + name + "'; only plumb_bob is known");
  }
  const YAML::Node matrix = reader.require(reader.require(root, "camera_matrix"), "data");
  std::vector<double> k;
  if (!YAML::convert<std::vector<double>>::decode(matrix, k) || k.size() != 9 || !(k[0] > 0.0) ||
      !(k[4] > 0.0)) {
    reader.fail(matrix, "camera_matrix", "must hold nine numbers with focal lengths above 0");
  }
  CameraFile result{.name = root["camera_name"].as<std::string>(""),
                    .camera = {.width = reader.pixels(root, "image_width"),
                               .height = reader.pixels(root, "image_height"),
                               .fx = k[0],
                               .fy = k[4],
                               .cx = k[2],
                               .cy = k[5]}};
  if (const YAML::Node coefficients = root["distortion_coefficients"]) {
    result.camera.distortion =
        reader.distortion(reader.require(coefficients, "data"), "distortion_coefficients");
  }
  return result;
}

}  // namespace

Expected<CameraFile> read_camera_file(const std::filesystem::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  try {
    const YAML::Node root = YAML::Load(*text);
    const Reader reader(file.string());
    if (!root.IsMap()) reader.fail(root, "", "is not a camera file");
    return root["camera_matrix"] ? read_camera_info(reader, root) : read_own(reader, root);
  } catch (const Fault& fault) {
    return fault.error;
  } catch (const YAML::Exception& error) {
    return Error{.message = error.msg, .file = file.string(), .line = error.mark.line + 1};
  }
}

}  // namespace pcavr
