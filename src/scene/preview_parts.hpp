// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/geometry/mesh.hpp"

#include "rasteriser.hpp"

namespace pcavr {

/// Tubes of `radius` [m] along a line, one for each of its parts.
[[nodiscard]] TriangleMesh tubes(const std::vector<Eigen::Vector3d>& line, double radius);

/// Fills the canvas with the colour of an empty sky, lighter above.
void draw_background(Canvas& canvas);

/// Darkens what lies behind a nearer neighbour, so that shapes stand out [Boucheny 2009, "eye-dome
/// lighting"], and draws an outline around each thing whose number is at least `first_outlined`.
void draw_contours(Canvas& canvas, std::uint8_t first_outlined);

/// A name with a line of its own colour beneath, above a point of the picture.
void draw_label(ColorImage& picture, const Eigen::Vector2d& at, const std::string& text,
                const Rgb8& color);

/// A bar with its length written on it, at the lower left. `metre` is the length of one metre in
/// the middle of the scene [px].
void draw_scale_bar(ColorImage& picture, double metre);

}  // namespace pcavr
