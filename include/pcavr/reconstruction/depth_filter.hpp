// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"

namespace pcavr {

/// Depth without the readings that lie: pixels at depth jumps (which mix two surfaces), lone
/// pixels, pixels outside the noise model's range and at grazing incidence. What is left is
/// unchanged.
[[nodiscard]] DepthImage filter_depth(const DepthImage& depth, const CameraModel& camera,
                                      const DepthNoise& noise, Parallelism parallelism);

}  // namespace pcavr
