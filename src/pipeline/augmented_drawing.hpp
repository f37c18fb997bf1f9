// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/model/cad_model.hpp"

namespace pcavr {

/// A body as a camera sees it.
struct BodyInView {
  const SurfaceQuery* surface = nullptr;  ///< must outlive the drawing
  Pose T_camera_object;
};

/// Draws bodies over the image that `camera` took: `solid` ones filled, half seen through, with
/// their edges; `ghosts` as thin lines only. Each pixel is four rays through the lens as it is, so
/// that distortion bends the bodies as it bends the picture. Nearer bodies hide farther ones of
/// their own kind; where the recorded depth (may be empty) is nearer than a solid body, that is
/// drawn faintly. The same bits for any Parallelism.
void draw_bodies(ColorImage& picture, const DepthImage& depth, const CameraModel& camera,
                 const std::vector<BodyInView>& solid, const std::vector<BodyInView>& ghosts,
                 Parallelism parallelism);

/// What the lines mean, at the lower left.
void draw_legend(ColorImage& picture, bool has_solid, bool has_ghosts);

}  // namespace pcavr
