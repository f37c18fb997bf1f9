// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

namespace pcavr {

/// A frame as it is fused: depth without flying pixels, and the colour on its grid, since finer
/// colour does not improve the surface.
struct FusedFrame {
  CameraModel camera;  ///< of both
  DepthImage depth;    ///< [m]
  ColorImage color;
};

/// `camera` is that of the colour images.
[[nodiscard]] FusedFrame fused_frame(const RgbdFrame& frame, const CameraModel& camera,
                                     const BuildOptions& options);

/// The fusion's options, with the noise of the sensor.
[[nodiscard]] TsdfOptions fusion_options(const BuildOptions& options);

/// A mask as the lengths of its runs of equal pixels, 0 first: most masks have few.
class PackedMask {
 public:
  PackedMask() = default;
  explicit PackedMask(const MaskImage& mask);
  /// Of runs() that another one had; they add up to all pixels.
  PackedMask(int width, int height, std::vector<std::uint32_t> runs)
      : width_(width), height_(height), runs_(std::move(runs)) {}
  [[nodiscard]] MaskImage unpacked() const;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const std::vector<std::uint32_t>& runs() const { return runs_; }

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint32_t> runs_;
};

}  // namespace pcavr
