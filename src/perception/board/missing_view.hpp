// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/perception/board/camera_calibration.hpp"

#include "perception/board/bundle.hpp"

namespace pcavr {

/// Fills `pixel_std` and `missing` of a calibration: of views with the board in each part of the
/// image, near and far, flat and tilted, the one that reduces pixel_std most, if by a tenth.
void plan_missing_view(const BundleFit& fit, const Board& board, const BundleOptions& options,
                       CameraCalibration& result);

}  // namespace pcavr
