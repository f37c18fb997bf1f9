// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/perception/scene/rasteriser.hpp"
#include "pcavr/perception/scene/scene.hpp"

namespace pcavr {

inline constexpr int kPreviewWidth = 1280;  ///< [px]
inline constexpr int kPreviewHeight = 960;  ///< [px]

/// The direction opposite to gravity, a unit vector in base: base's z axis, unless what the camera
/// saw shows another: level surfaces, or its pictures, where the world frame is that of its first
/// view.
[[nodiscard]] Eigen::Vector3d up_direction(const Scene& scene);

/// Viewpoint of the preview: oblique, from above the support planes and their objects, on the
/// recording camera's side. Without planes and objects: from behind the recording camera.
[[nodiscard]] View choose_view(const Scene& scene, int width, int height);

/// Renders the scene with objects, base axes and the camera trajectory.
[[nodiscard]] ColorImage render_preview(const Scene& scene, Parallelism parallelism);

}  // namespace pcavr
