// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/recording/frame_reader.hpp"

namespace pcavr {

/// Marks the tool, where `tool.csv` and the tip's radius tell where its tip is: the disc that the
/// tip covers, whatever depth was measured there, and what hangs together with it in depth above
/// it: the shaft, the hand, the arm. What lies lower than the tip's centre is never marked beyond
/// the disc, so that a tip that touches the table does not take the table along.
void mask_tool(const Recording& recording, const RgbdFrame& frame, const Pose& T_base_camera,
               MaskImage& mask);

}  // namespace pcavr
