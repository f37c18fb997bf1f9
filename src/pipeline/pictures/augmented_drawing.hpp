// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {

/// A body and its pose in a camera.
struct BodyInView {
  const SurfaceQuery* surface = nullptr;  ///< must outlive the drawing
  Pose T_camera_object;
};

/// Draws bodies over an image of `camera` by ray casting: `solid` ones filled, half transparent,
/// with their edges; `ghosts` as thin lines only. Each pixel is sampled by four rays through the
/// lens model with its distortion, so that drawn bodies and image agree. Nearer bodies occlude
/// farther ones of their own kind; where the recorded depth (may be empty) occludes a solid body,
/// that is drawn faintly. The result does not depend on the Parallelism, bit for bit.
void draw_bodies(ColorImage& picture, const DepthImage& depth, const CameraModel& camera,
                 const std::vector<BodyInView>& solid, const std::vector<BodyInView>& ghosts,
                 Parallelism parallelism);

/// The legend of the line colours, at the lower left.
void draw_legend(ColorImage& picture, bool has_solid, bool has_ghosts);

}  // namespace pcavr
