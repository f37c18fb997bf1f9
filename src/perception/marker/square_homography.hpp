// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace pcavr {

/// The homography that maps the square (-1,-1) (1,-1) (1,1) (-1,1), y up, to the four corners.
[[nodiscard]] Eigen::Matrix3d square_homography(const std::array<Eigen::Vector2d, 4>& corners);

}  // namespace pcavr
