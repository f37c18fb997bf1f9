// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/base/geometry/image.hpp"

#include "charts.hpp"
#include "painted_view.hpp"

namespace pcavr {

/// Places of the charts in the atlas.
struct AtlasLayout {
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
};

/// Chooses each chart's resolution by its nearest view, coarser in the same ratio where the atlas
/// is too small, and packs the charts: sets their `texel` and `corner`. Without
/// size where there are too many charts.
[[nodiscard]] AtlasLayout lay_out(ChartSet& set, const std::vector<TriangleMesh>& levels_base,
                                  const std::vector<PaintedView>& views,
                                  const TextureOptions& options);

/// A point in pixels of the atlas; the centre of texel (0, 0) is (0, 0).
[[nodiscard]] Eigen::Vector2f in_atlas(const Chart& chart, const Eigen::Vector3f& p_base);

/// Returns a level's texture coordinates; a vertex of several charts gets a copy for each. Normals
/// must be set.
[[nodiscard]] TextureCoordinates split_by_charts(
    TriangleMesh& level_base, const std::vector<std::uint32_t>& chart_of_triangle,
    const std::vector<Chart>& charts, const AtlasLayout& layout);

/// A texel without surface.
inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFU;

/// The triangle that each texel shows, numbered through all levels, finest first; a margin of one
/// texel around each chart included.
[[nodiscard]] Image<std::uint32_t> draw_triangles(
    const std::vector<TriangleMesh>& levels_base,
    const std::vector<TextureCoordinates>& coordinates, const AtlasLayout& layout);

}  // namespace pcavr
