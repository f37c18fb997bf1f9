// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"

namespace pcavr {

/// The pixel grid of a depth camera in the rays of its unorganised cloud (x / z and y / z), so that
/// each ray passes through a pixel's centre: an image on it needs no resampling. The grid is found
/// in `rays`, and the image holds `all_rays`. nullopt where the rays lie on no grid.
[[nodiscard]] std::optional<CameraModel> find_ray_grid(
    const std::vector<Eigen::Vector2f>& rays, const std::vector<Eigen::Vector2f>& all_rays);

}  // namespace pcavr
