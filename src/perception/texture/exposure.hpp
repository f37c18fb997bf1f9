// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/parallel.hpp"

#include "painted_view.hpp"

namespace pcavr {

/// A surface point, and the views that see it.
struct SeenPoint {
  Eigen::Vector3f p_base;
  std::vector<std::uint32_t> views;
};

/// A point's colour in a view.
struct SeenColor {
  std::uint32_t view = 0;
  RawColor raw;
};

/// The colours of each point in the views where the sensor was not saturated.
using SeenColors = std::vector<std::vector<SeenColor>>;

/// Sets each view's gain and offset by channel, so that it agrees with the median over the views:
/// automatic exposure and white balance change the gain, stray light and the black level the
/// offset. The vignetting, which is the camera's, is estimated too (vignetting.hpp). Over the
/// views, the geometric mean of the gains is 1, the mean of the offsets 0. Bitwise identical for
/// any Parallelism.
void even_out_exposures(std::vector<PaintedView>& views, const std::vector<SeenPoint>& points,
                        Parallelism parallelism);

}  // namespace pcavr
