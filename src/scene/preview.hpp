// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/core/parallel.hpp"
#include "pcavr/scene/scene.hpp"

#include "rasteriser.hpp"

namespace pcavr {

inline constexpr int kPreviewWidth = 1280;  ///< [px]
inline constexpr int kPreviewHeight = 960;  ///< [px]

/// A view that shows the scene well: obliquely from above the support planes and their objects,
/// from the side that the camera looked from. Without either, over the camera's shoulder.
[[nodiscard]] View choose_view(const Scene& scene, int width, int height);

/// A picture of the scene, objects, base axes and the camera's path included.
[[nodiscard]] ColorImage render_preview(const Scene& scene, Parallelism parallelism);

/// The bytes of a PNG file.
[[nodiscard]] std::string format_png(const ColorImage& image);

}  // namespace pcavr
