// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

/// Replaces the pixels where `is_known` is zero by smooth colours from around (push-pull
/// [Gortler et al. 1996, sec. 3.4]): mipmaps and JPEG see no border around the charts.
void fill_gaps(ColorImage& image, const MaskImage& is_known);

/// Continues the colours of the other seen pixels into doubtful ones, pixel by pixel: each takes
/// the mean of those around it. Those farther than 12 px from all keep their colours.
void continue_colors(ColorImage& image, const MaskImage& is_seen, const MaskImage& is_doubtful);

}  // namespace pcavr
