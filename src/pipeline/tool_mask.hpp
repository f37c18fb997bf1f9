// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/recording/frame_reader.hpp"

#include "tool_shape.hpp"

namespace pcavr {

/// Finds the tool in frame after frame, where `tool.csv` and the tip's radius tell where its tip
/// is: the disc that the tip covers, whatever depth was measured there, and what hangs together
/// with it in depth above it: the shaft, the hand, the arm. What lies lower than the tip's centre
/// is never marked beyond the disc, so that a tip that touches the table does not take the table
/// along. What went along with the tip is remembered, and found again where a body hides the tip.
/// One thread at a time.
class ToolMask {
 public:
  /// `recording` has to outlive this.
  explicit ToolMask(const Recording& recording) : recording_(recording) {}

  /// Frames in their order; `mask` holds the movable bodies already.
  void mark(const RgbdFrame& frame, const Pose& T_base_camera, MaskImage& mask);

 private:
  const Recording& recording_;
  ToolShape shape_;
};

}  // namespace pcavr
