// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

/// Gives the smooth colours of each gap the grain of the known pixels beside it: copied from where,
/// at one offset for the whole gap, the grain around it agrees best [Pritch et al. 2009, sec. 2;
/// one label]. A gap without such a place that is known and of a similar contrast stays smooth.
void synthesise_grain(ColorImage& image, const MaskImage& is_known, const MaskImage& is_gap);

}  // namespace pcavr
