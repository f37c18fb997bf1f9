// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// The plane with the most inliers within `distance` [m], with an upward normal whose z is at least
/// `min_upward` (PCL's RANSAC with its fixed seed: deterministic).
[[nodiscard]] std::optional<Plane> ransac_plane(const std::vector<Eigen::Vector3d>& points,
                                                double distance, double min_upward);

}  // namespace pcavr
