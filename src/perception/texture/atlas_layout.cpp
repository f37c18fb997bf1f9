// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "atlas_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "atlas_packing.hpp"

namespace pcavr {
namespace {

/// Empty texels around a chart [px]: bilinear interpolation and two mipmaps do not reach the next.
constexpr int kPadding = 3;
constexpr int kSizeStep = 16;  ///< [px]; width and height are multiples, for JPEG's blocks
constexpr float kCoarser = 1.05F;
constexpr int kMaxRounds = 150;       ///< up to 1500 times coarser
constexpr std::size_t kSamples = 24;  ///< of a chart's distances from the views
constexpr float kMinTexel = 1e-4F;    ///< [m]

/// Size of a pixel of the nearest view that may see the point [m]; nullopt where none does.
std::optional<float> footprint_at(const Eigen::Vector3f& p_base,
                                  const std::vector<PaintedView>& views) {
  std::optional<float> smallest;
  for (const PaintedView& view : views) {
    if (!view.may_see(p_base, 0.0F)) continue;
    const float footprint = (view.position_base().cast<float>() - p_base).norm() / view.focal();
    if (!smallest || footprint < *smallest) smallest = footprint;
  }
  return smallest;
}

/// The size of a pixel in the nearest view of each chart [m].
std::vector<float> footprints(const ChartSet& set, const TriangleMesh& coarse,
                              const std::vector<PaintedView>& views) {
  std::vector<std::vector<std::uint32_t>> members(set.charts.size());
  const std::vector<std::uint32_t>& chart_of = set.chart_of_triangle.back();
  for (std::uint32_t i = 0; i < chart_of.size(); ++i) members[chart_of[i]].push_back(i);
  std::vector<std::optional<float>> by_chart;
  std::vector<float> known;
  for (const std::vector<std::uint32_t>& triangles : members) {
    std::vector<float> samples;
    const std::size_t stride = triangles.size() / kSamples + 1;
    for (std::size_t i = 0; i < triangles.size(); i += stride) {
      const auto& [a, b, c] = coarse.triangles[triangles[i]];
      const auto footprint = footprint_at(
          (coarse.vertices[a] + coarse.vertices[b] + coarse.vertices[c]) / 3.0F, views);
      if (footprint) samples.push_back(*footprint);
    }
    by_chart.emplace_back();
    if (samples.empty()) continue;
    std::sort(samples.begin(), samples.end());
    by_chart.back() = samples[samples.size() / 3];
    known.push_back(*by_chart.back());
  }
  std::sort(known.begin(), known.end());
  // Charts that no view sees have only the vertices' colours.
  const float unseen = known.empty() ? 0.02F : 4.0F * known[known.size() / 2];
  std::vector<float> result;
  for (const std::optional<float>& footprint : by_chart)
    result.push_back(footprint.value_or(unseen));
  return result;
}

Eigen::Vector2i size_of(const Chart& chart) {
  const Eigen::Vector2f texels = chart.box.sizes() / chart.texel;
  return {static_cast<int>(std::ceil(texels.x())) + 1 + 2 * kPadding,
          static_cast<int>(std::ceil(texels.y())) + 1 + 2 * kPadding};
}

float cross(const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

AtlasLayout lay_out(ChartSet& set, const std::vector<TriangleMesh>& levels_base,
                    const std::vector<PaintedView>& views, const TextureOptions& options) {
  const std::vector<float> finest = footprints(set, levels_base.back(), views);
  float scale = 1.0F / static_cast<float>(options.texels_per_pixel);
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<Eigen::Vector2i> sizes;
    for (std::size_t i = 0; i < set.charts.size(); ++i) {
      set.charts[i].texel = std::max(kMinTexel, scale * finest[i]);
      sizes.push_back(size_of(set.charts[i]));
    }
    const auto corners = pack_rectangles(sizes, options.atlas_width, options.atlas_height);
    scale *= kCoarser;
    if (!corners) continue;
    Eigen::Vector2i used = Eigen::Vector2i::Zero();
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      set.charts[i].corner = (*corners)[i];
      used = used.cwiseMax((*corners)[i] + sizes[i]);
    }
    const auto up_to = [](int length, int max) {
      return std::min(max, (length + kSizeStep - 1) / kSizeStep * kSizeStep);
    };
    return {up_to(used.x(), options.atlas_width), up_to(used.y(), options.atlas_height)};
  }
  return {};
}

Eigen::Vector2f in_atlas(const Chart& chart, const Eigen::Vector3f& p_base) {
  return (chart.on_axes(p_base) - chart.box.min()) / chart.texel +
         (chart.corner.array() + kPadding).cast<float>().matrix();
}

TextureCoordinates split_by_charts(TriangleMesh& level_base,
                                   const std::vector<std::uint32_t>& chart_of_triangle,
                                   const std::vector<Chart>& charts, const AtlasLayout& layout) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  TriangleMesh split;
  TextureCoordinates coordinates;
  split.triangles.reserve(level_base.triangles.size());
  struct Copy {
    std::uint32_t chart;
    std::uint32_t next;  ///< copy of the same vertex
  };
  std::vector<Copy> copies;  ///< by vertex of `split`
  std::vector<std::uint32_t> first(level_base.vertices.size(), kNone);
  const Eigen::Array2f size(static_cast<float>(layout.width), static_cast<float>(layout.height));
  const auto copy_in = [&](std::uint32_t vertex, std::uint32_t chart) {
    for (std::uint32_t copy = first[vertex]; copy != kNone; copy = copies[copy].next) {
      if (copies[copy].chart == chart) return copy;
    }
    const auto copy = static_cast<std::uint32_t>(copies.size());
    copies.push_back({chart, first[vertex]});
    first[vertex] = copy;
    const Eigen::Vector3f& point = level_base.vertices[vertex];
    split.vertices.push_back(point);
    split.normals.push_back(level_base.normals[vertex]);
    if (!level_base.colors.empty()) split.colors.push_back(level_base.colors[vertex]);
    coordinates.emplace_back(((in_atlas(charts[chart], point).array() + 0.5F) / size).matrix());
    return copy;
  };
  for (std::size_t i = 0; i < level_base.triangles.size(); ++i) {
    const auto& [a, b, c] = level_base.triangles[i];
    const std::uint32_t chart = chart_of_triangle[i];
    const std::uint32_t first_copy = copy_in(a, chart);
    const std::uint32_t second_copy = copy_in(b, chart);
    split.triangles.push_back({first_copy, second_copy, copy_in(c, chart)});
  }
  level_base = std::move(split);
  return coordinates;
}

Image<std::uint32_t> draw_triangles(const std::vector<TriangleMesh>& levels_base,
                                    const std::vector<TextureCoordinates>& coordinates,
                                    const AtlasLayout& layout) {
  Image<std::uint32_t> drawn(layout.width, layout.height, kNoTriangle);
  const Eigen::Array2f size(static_cast<float>(layout.width), static_cast<float>(layout.height));
  // Texels inside a triangle come first, then the margin.
  for (const float margin : {0.01F, 1.0F}) {
    std::uint32_t number = 0;
    for (std::size_t level = 0; level < levels_base.size(); ++level) {
      for (const auto& triangle : levels_base[level].triangles) {
        std::array<Eigen::Vector2f, 3> at;
        Eigen::AlignedBox2f box;
        for (std::size_t i = 0; i < 3; ++i) {
          at[i] = (coordinates[level][triangle[i]].array() * size - 0.5F).matrix();
          box.extend(at[i]);
        }
        const float turn = cross(at[1] - at[0], at[2] - at[0]) < 0.0F ? -1.0F : 1.0F;
        std::array<Eigen::Vector2f, 3> side;  // of the length that makes `cross` a distance
        for (std::size_t i = 0; i < 3; ++i) {
          side[i] = at[(i + 1) % 3] - at[i];
          side[i] *= turn / std::max(side[i].norm(), 1e-9F);
        }
        const int left = std::max(0, static_cast<int>(std::ceil(box.min().x() - margin)));
        const int right =
            std::min(layout.width - 1, static_cast<int>(std::floor(box.max().x() + margin)));
        const int top = std::max(0, static_cast<int>(std::ceil(box.min().y() - margin)));
        const int bottom =
            std::min(layout.height - 1, static_cast<int>(std::floor(box.max().y() + margin)));
        const auto is_inside = [&](const Eigen::Vector2f& texel) {
          for (std::size_t i = 0; i < 3; ++i) {
            if (cross(side[i], texel - at[i]) < -margin) return false;
          }
          return true;
        };
        for (int y = top; y <= bottom; ++y) {
          for (int x = left; x <= right; ++x) {
            if (drawn(x, y) != kNoTriangle) continue;
            if (is_inside({static_cast<float>(x), static_cast<float>(y)})) drawn(x, y) = number;
          }
        }
        ++number;
      }
    }
  }
  return drawn;
}

}  // namespace pcavr
