// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recording/camera_keys.hpp"

#include <algorithm>

namespace pcavr {

std::array<double, 5> distortion_of(const YamlValue& value) {
  std::array<double, 5> distortion{};
  const std::vector<double> numbers = value.numbers(distortion.size());
  std::copy(numbers.begin(), numbers.end(), distortion.begin());
  return distortion;
}

CameraModel camera_of(const YamlValue& value) {
  CameraModel camera{.width = value.at("width").integer(1, kLargestImageSide),
                     .height = value.at("height").integer(1, kLargestImageSide),
                     .fx = value.at("fx").positive_number(),
                     .fy = value.at("fy").positive_number(),
                     .cx = value.at("cx").number(),
                     .cy = value.at("cy").number()};
  if (const auto distortion = value.find("distortion")) {
    camera.distortion = distortion_of(*distortion);
  }
  return camera;
}

}  // namespace pcavr
