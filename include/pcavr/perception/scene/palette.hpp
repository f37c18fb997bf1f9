// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

// The colours (sRGB) of objects and of sources of poses in pictures, meshes and videos: those of
// the page and the reports, apps/viewer/src/palette.json. Tests compare both, and the colours'
// differences for every kind of colour vision.

/// Colours of movable objects, in the order of the scene.
inline constexpr std::array<Rgb8, 6> kObjectColors = {{{0x38, 0x8b, 0xff},
                                                       {0xc6, 0x77, 0x17},
                                                       {0x12, 0x6f, 0x52},
                                                       {0x7f, 0x67, 0x86},
                                                       {0xe3, 0xcf, 0xac},
                                                       {0x55, 0x09, 0xed}}};
/// Colour of objects that do not move.
inline constexpr Rgb8 kFixedObjectColor{0x35, 0x3d, 0x46};

inline constexpr Rgb8 kPredictedColor{0xbf, 0x84, 0x20};
inline constexpr Rgb8 kTrackedColor{0x4f, 0x82, 0xfb};
inline constexpr Rgb8 kMeasuredColor{0x24, 0x68, 0x5a};

/// The colour of the movable object with this index among the movable ones.
[[nodiscard]] constexpr const Rgb8& object_color(std::size_t movable) {
  return kObjectColors[movable % kObjectColors.size()];
}

}  // namespace pcavr
