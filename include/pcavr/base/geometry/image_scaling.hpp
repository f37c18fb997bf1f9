// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

/// The image downsampled by two: each pixel the mean of four.
[[nodiscard]] ColorImage halved(const ColorImage& image);

}  // namespace pcavr
