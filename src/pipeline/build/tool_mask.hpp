// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/recordings/recording/frame_reader.hpp"

#include "tool_shape.hpp"

namespace pcavr {

/// Masks the tool in each frame, where `tool.csv` and the tip's radius give the tip's position: the
/// disc that the tip covers, whatever depth was measured there, and by region growing what is
/// connected with it in depth above it: the shaft, the hand, the arm. Nothing lower than the tip's
/// centre is masked beyond the disc, so that the region does not grow into a table that the tip
/// touches. The shape that moves with the tip is stored (ToolShape), and is found again where a
/// body occludes the tip. Not thread-safe.
class ToolMask {
 public:
  /// `recording` has to outlive this.
  explicit ToolMask(const Recording& recording, const MaskOptions& options = {})
      : recording_(recording), options_(options), shape_(options) {}

  /// Call with the frames in order; `mask` contains the movable bodies already.
  void mark(const RgbdFrame& frame, const Pose& T_base_camera, MaskImage& mask);

 private:
  const Recording& recording_;
  MaskOptions options_;
  ToolShape shape_;
};

}  // namespace pcavr
