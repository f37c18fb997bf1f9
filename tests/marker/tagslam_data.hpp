// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "pcavr/perception/marker/body_pose.hpp"

namespace pcavr {

inline CameraModel tagslam_camera() {
  return {.width = 1280,
          .height = 1024,
          .fx = 1506.9,
          .fy = 1506.28,
          .cx = 641.176,
          .cy = 524.495,
          .distortion = {-0.233024, 0.217972, 0.000104351, -9.65731e-05, -0.0913426}};
}

inline std::vector<TagPlacement> read_body(const std::filesystem::path& file,
                                           const std::string& body) {
  std::vector<TagPlacement> placements;
  for (const YAML::Node& entry : YAML::LoadFile(file.string())["bodies"]) {
    if (!entry[body]) continue;
    for (const YAML::Node& tag : entry[body]["tags"]) {
      const auto vector = [&](const char* key) {
        const YAML::Node node = tag["pose"][key];
        return Eigen::Vector3d(node["x"].as<double>(), node["y"].as<double>(),
                               node["z"].as<double>());
      };
      Vector6d rotation = Vector6d::Zero();
      rotation.tail<3>() = vector("rotation");
      placements.push_back({{"tag36h11", tag["id"].as<int>()},
                            tag["size"].as<double>(),
                            Pose::from_translation(vector("position")) * Pose::exp(rotation)});
    }
  }
  return placements;
}

struct CornerFrame {
  std::string stamp;  ///< [s]
  std::vector<TagDetection> detections;
};

inline std::vector<CornerFrame> read_corners(const std::filesystem::path& file) {
  std::vector<CornerFrame> frames;
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::vector<std::string> fields;
    std::istringstream row(line);
    for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
    if (frames.empty() || frames.back().stamp != fields.at(0)) frames.push_back({fields[0], {}});
    TagDetection detection;
    detection.id = {"tag36h11", std::stoi(fields.at(2))};
    for (std::size_t i = 0; i < 4; ++i) {
      detection.corners[i] = {std::stod(fields.at(5 + 2 * i)), std::stod(fields.at(6 + 2 * i))};
    }
    frames.back().detections.push_back(detection);
  }
  return frames;
}

}  // namespace pcavr
