// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"

namespace pcavr {

/// Images of a camera with lens distortion as one without it would take them, of the same focal
/// length. Through a rational lens or a fisheye, which see more to the sides than a pinhole of that
/// size, its image is larger: it takes in what the lens sees up to 60 degrees from the optical
/// axis. Pixels are taken whole: a mean of two depths may lie on neither surface.
class Undistortion {
 public:
  /// Makes the map anew only if the camera has changed.
  void prepare(const CameraModel& camera);

  /// Of the images without distortion.
  [[nodiscard]] const CameraModel& ideal_camera() const { return ideal_; }

  template <typename Pixel>
  [[nodiscard]] Image<Pixel> operator()(const Image<Pixel>& distorted) const {
    if (distorted.empty()) return {};
    Image<Pixel> ideal(ideal_.width, ideal_.height);
    for (std::size_t i = 0; i < source_.size(); ++i) {
      if (source_[i] >= 0) {
        ideal.pixels()[i] = distorted.pixels()[static_cast<std::size_t>(source_[i])];
      }
    }
    return ideal;
  }

 private:
  std::optional<CameraModel> camera_;
  CameraModel ideal_;
  std::vector<std::int32_t> source_;  ///< for each ideal pixel the distorted one, or -1
};

}  // namespace pcavr
