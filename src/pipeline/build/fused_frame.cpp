// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "fused_frame.hpp"

#include <algorithm>
#include <span>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/perception/reconstruction/depth_filter.hpp"

namespace pcavr {

FusedFrame fused_frame(const RgbdFrame& frame, const CameraModel& camera,
                       const BuildOptions& options) {
  const int width = frame.depth.width();
  const int height = frame.depth.height();
  FusedFrame fused{.camera = on_grid(camera, width, height), .depth = {}, .color = {}};
  fused.color =
      fused.camera.width == camera.width ? frame.color : color_on_grid(frame.color, width, height);
  fused.depth =
      filter_depth(frame.depth, fused.camera, options.perception.depth_noise, options.parallelism);
  return fused;
}

TsdfOptions fusion_options(const BuildOptions& options) {
  TsdfOptions fusion = options.fusion;
  fusion.depth_noise = options.perception.depth_noise;
  return fusion;
}

PackedMask::PackedMask(const MaskImage& mask) : width_(mask.width()), height_(mask.height()) {
  bool is_set = false;
  std::uint32_t run = 0;
  for (const std::uint8_t pixel : mask.pixels()) {
    if ((pixel != 0) != is_set) {
      runs_.push_back(run);
      run = 0;
      is_set = !is_set;
    }
    ++run;
  }
  runs_.push_back(run);
}

MaskImage PackedMask::unpacked() const {
  MaskImage mask(width_, height_);
  const std::span<std::uint8_t> pixels = mask.pixels();
  std::size_t begin = 0;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    if (i % 2 == 1) std::fill_n(pixels.begin() + static_cast<std::ptrdiff_t>(begin), runs_[i], 1);
    begin += runs_[i];
  }
  return mask;
}

}  // namespace pcavr
