// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"

#include "rasteriser.hpp"

namespace pcavr {

/// Tubes of `radius` [m] along a polyline, one per segment.
[[nodiscard]] TriangleMesh tubes(const std::vector<Eigen::Vector3d>& line, double radius);

/// Fills the canvas with a vertical colour gradient.
void draw_background(Canvas& canvas);

/// Eye-dome lighting [Boucheny 2009]: darkens pixels behind a nearer neighbour; and draws an
/// outline around each object whose id is at least `first_outlined`: of its colour in `colors`,
/// which begin with that id, or a dark one.
void draw_contours(Canvas& canvas, std::uint8_t first_outlined,
                   const std::vector<std::optional<Rgb8>>& colors = {});

/// A text underlined with `color`, above a point of the image.
void draw_label(ColorImage& picture, const Eigen::Vector2d& at, const std::string& text,
                const Rgb8& color);

/// A labelled scale bar at the lower left. `metre` is the length of one metre at the centre of the
/// scene [px].
void draw_scale_bar(ColorImage& picture, double metre);

}  // namespace pcavr
