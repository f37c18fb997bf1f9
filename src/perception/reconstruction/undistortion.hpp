// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

/// Undistorts (rectifies) images, with the same focal length. For a wide rational or fisheye lens
/// the undistorted image is larger: it covers the field of view up to 60 degrees from the optical
/// axis. Nearest-neighbour lookup: a mean of two depths may lie on neither surface.
class Undistortion {
 public:
  /// Recomputes the lookup table only if the camera has changed.
  void prepare(const CameraModel& camera);

  /// The camera model of the undistorted images.
  [[nodiscard]] const CameraModel& undistorted_camera() const { return undistorted_; }

  template <typename Pixel>
  [[nodiscard]] Image<Pixel> operator()(const Image<Pixel>& distorted) const {
    if (distorted.empty()) return {};
    Image<Pixel> undistorted(undistorted_.width, undistorted_.height);
    for (std::size_t i = 0; i < source_.size(); ++i) {
      if (source_[i] >= 0) {
        undistorted.pixels()[i] = distorted.pixels()[static_cast<std::size_t>(source_[i])];
      }
    }
    return undistorted;
  }

 private:
  std::optional<CameraModel> camera_;
  CameraModel undistorted_;
  std::vector<std::int32_t> source_;  ///< for each undistorted pixel the distorted one, or -1
};

}  // namespace pcavr
