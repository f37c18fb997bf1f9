// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"

namespace pcavr {

/// Images of a camera with lens distortion as the same camera without it would take them. Pixels
/// are taken whole: a mean of two depths may lie on neither surface.
class Undistortion {
 public:
  /// Makes the map anew only if the camera has changed.
  void prepare(const CameraModel& camera);

  template <typename Pixel>
  [[nodiscard]] Image<Pixel> operator()(const Image<Pixel>& distorted) const {
    if (distorted.empty()) return {};
    Image<Pixel> ideal(distorted.width(), distorted.height());
    for (std::size_t i = 0; i < source_.size(); ++i) {
      if (source_[i] >= 0) {
        ideal.pixels()[i] = distorted.pixels()[static_cast<std::size_t>(source_[i])];
      }
    }
    return ideal;
  }

 private:
  std::optional<CameraModel> camera_;
  std::vector<std::int32_t> source_;  ///< for each ideal pixel the distorted one, or -1
};

}  // namespace pcavr
