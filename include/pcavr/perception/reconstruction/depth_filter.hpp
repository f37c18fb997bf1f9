// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

/// Removes invalid depth: flying pixels at depth discontinuities (which mix two surfaces), isolated
/// pixels, pixels outside the noise model's range and at grazing incidence. The others are
/// unchanged.
[[nodiscard]] DepthImage filter_depth(const DepthImage& depth, const CameraModel& camera,
                                      const DepthNoise& noise, Parallelism parallelism);

}  // namespace pcavr
