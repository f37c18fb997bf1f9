// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/texture/mesh_texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "atlas_layout.hpp"
#include "charts.hpp"
#include "color_alignment.hpp"
#include "fill_gaps.hpp"
#include "painted_view.hpp"

namespace pcavr {
namespace {

constexpr int kBlock = 32;  ///< [px] edge of a block of texels that shares its list of views

/// Share of the best view's weight below which a view is left out: with the default exponent, it
/// has less than 0.1 % of the best one's share of the mean.
constexpr float kNegligible = 0.1F;

/// A point of the surface that a texel shows.
struct Texel {
  Eigen::Vector3f p_base;
  Eigen::Vector3f normal_base;
  Eigen::Vector3f fused;  ///< colour by the vertices
};

/// A view's colour of a texel.
struct Sample {
  Eigen::Vector3f color;
  float weight;
  float luma;
};

/// The robust mean of the views' colours: the median over the views, then a mean of those near it
/// in which the best views count most.
Eigen::Vector3f blend(std::vector<Sample>& samples, const TextureOptions& options) {
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.luma < b.luma; });
  float all = 0.0F;
  float best = 0.0F;
  for (const Sample& sample : samples) {
    all += sample.weight;
    best = std::max(best, sample.weight);
  }
  float below = 0.0F;
  std::size_t median = 0;
  for (; median + 1 < samples.size(); ++median) {
    below += samples[median].weight;
    if (below >= 0.5F * all) break;
  }
  const Eigen::Vector3f middle = samples[median].color;
  const auto outlier = static_cast<float>(options.color_outlier);
  const auto exponent = static_cast<float>(options.best_view_exponent);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float weights = 0.0F;
  for (const Sample& sample : samples) {
    const float difference = (sample.color - middle).cwiseAbs().maxCoeff() / outlier;
    // Geman and McClure's weight.
    const float agreement =
        1.0F / ((1.0F + difference * difference) * (1.0F + difference * difference));
    const float weight = agreement * std::pow(sample.weight / best, exponent);
    sum += weight * sample.color;
    weights += weight;
  }
  return sum / weights;
}

class AtlasPainter {
 public:
  AtlasPainter(const std::vector<TriangleMesh>& levels,
               const std::vector<TextureCoordinates>& coordinates,
               const Image<std::uint32_t>& triangles, const std::vector<PaintedView>& views,
               const TextureOptions& options)
      : levels_(levels),
        coordinates_(coordinates),
        triangles_(triangles),
        views_(views),
        options_(options),
        image_(triangles.width(), triangles.height()),
        is_known_(triangles.width(), triangles.height()),
        is_seen_(triangles.width(), triangles.height()),
        is_doubtful_(triangles.width(), triangles.height()) {}

  void paint(Parallelism parallelism) {
    const int columns = (image_.width() + kBlock - 1) / kBlock;
    const int rows = (image_.height() + kBlock - 1) / kBlock;
    const auto blocks = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    parallel_for(parallelism, blocks, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto block = static_cast<int>(i);
        paint_block(block % columns * kBlock, block / columns * kBlock);
      }
    });
    continue_colors(image_, is_seen_, is_doubtful_);
    fill_gaps(image_, is_known_);
  }

  [[nodiscard]] ColorImage take_image() { return std::move(image_); }
  /// Share of the texels on charts with a colour from an image.
  [[nodiscard]] double seen_fraction() const {
    const auto count = [](const MaskImage& mask) {
      return static_cast<double>(std::count(mask.pixels().begin(), mask.pixels().end(), 1));
    };
    return count(is_known_) > 0.0 ? count(is_seen_) / count(is_known_) : 0.0;
  }

 private:
  [[nodiscard]] Texel texel_at(int x, int y) const {
    std::size_t triangle = triangles_(x, y);
    std::size_t level = 0;
    while (triangle >= levels_[level].triangles.size())
      triangle -= levels_[level++].triangles.size();
    const TriangleMesh& mesh = levels_[level];
    const std::uint32_t a = mesh.triangles[triangle][0];
    const std::uint32_t b = mesh.triangles[triangle][1];
    const std::uint32_t c = mesh.triangles[triangle][2];
    const Eigen::Array2f size(static_cast<float>(image_.width()),
                              static_cast<float>(image_.height()));
    const auto at = [&](std::uint32_t v) -> Eigen::Vector2f {
      return (coordinates_[level][v].array() * size - 0.5F).matrix();
    };
    const Eigen::Vector2f origin = at(a);
    const Eigen::Vector2f to_b = at(b) - origin;
    const Eigen::Vector2f to_c = at(c) - origin;
    const Eigen::Vector2f to = Eigen::Vector2f(float(x), float(y)) - origin;
    const float area = to_b.x() * to_c.y() - to_b.y() * to_c.x();
    Eigen::Array3f weights(1.0F, 0.0F, 0.0F);
    if (std::abs(area) > 1e-6F) {
      weights[1] = (to.x() * to_c.y() - to.y() * to_c.x()) / area;
      weights[2] = (to_b.x() * to.y() - to_b.y() * to.x()) / area;
      weights[0] = 1.0F - weights[1] - weights[2];
      weights = weights.max(0.0F);  // the margin has its border's colours
      weights /= weights.sum();
    }
    const auto mean = [&](const auto& values) -> Eigen::Vector3f {
      return weights[0] * values[a] + weights[1] * values[b] + weights[2] * values[c];
    };
    const auto color = [&](std::uint32_t v) {
      const Rgb8& rgb = mesh.colors[v];
      return Eigen::Vector3f(rgb.r, rgb.g, rgb.b);
    };
    return {mean(mesh.vertices), mean(mesh.normals).normalized(),
            weights[0] * color(a) + weights[1] * color(b) + weights[2] * color(c)};
  }

  void paint_block(int left, int top) {
    struct Entry {
      int x;
      int y;
      Texel texel;
    };
    std::vector<Entry> entries;
    Eigen::AlignedBox3f box;
    for (int y = top; y < std::min(top + kBlock, image_.height()); ++y) {
      for (int x = left; x < std::min(left + kBlock, image_.width()); ++x) {
        if (triangles_(x, y) == kNoTriangle) continue;
        entries.push_back({x, y, texel_at(x, y)});
        box.extend(entries.back().texel.p_base);
      }
    }
    if (entries.empty()) return;
    std::vector<const PaintedView*> views;
    for (const PaintedView& view : views_) {
      if (view.may_see(box.center(), 0.5F * box.diagonal().norm() + 1e-3F)) views.push_back(&view);
    }
    std::vector<SeenFrom> sightings;
    std::vector<Sample> samples;
    std::size_t best = 0;
    for (const Entry& entry : entries) {
      best = look_up(views, entry.texel, best, sightings);
      samples.clear();
      for (const auto& [view, sighting] : sightings) {
        const Eigen::Vector3f color = view->sharp_color_at(sighting.pixel);
        samples.push_back(
            {color, sighting.weight, 0.3F * color.x() + 0.6F * color.y() + 0.1F * color.z()});
      }
      is_seen_(entry.x, entry.y) = samples.empty() ? 0 : 1;
      set(entry.x, entry.y, samples.empty() ? entry.texel.fused : blend(samples, options_));
      is_doubtful_(entry.x, entry.y) = is_doubtful(views, entry.texel, sightings) ? 1 : 0;
    }
  }

  struct SeenFrom {
    const PaintedView* view;
    Sighting sighting;
  };

  /// The views that see a texel, without those that would not change its colour. Returns the index
  /// of the one with the largest weight. `likely` is that of a texel nearby: it is looked up first,
  /// as most others need not be examined further then.
  static std::size_t look_up(const std::vector<const PaintedView*>& views, const Texel& texel,
                             std::size_t likely, std::vector<SeenFrom>& sightings) {
    sightings.clear();
    if (views.empty()) return 0;
    const auto first = views[likely]->look_up(texel.p_base, texel.normal_base);
    float max_weight = first ? first->weight : 0.0F;
    std::size_t best = likely;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const auto sighting = i == likely ? first
                                        : views[i]->look_up(texel.p_base, texel.normal_base,
                                                            kNegligible * max_weight);
      if (!sighting) continue;
      if (sighting->weight > max_weight) {
        max_weight = sighting->weight;
        best = i;
      }
      sightings.push_back({views[i], *sighting});
    }
    std::erase_if(sightings, [&](const SeenFrom& seen) {
      return seen.sighting.weight < kNegligible * max_weight;
    });
    return best;
  }

  /// Whether the colour may be that of a nearer surface: all views see one beside the texel, or
  /// none sees it and one lies just in front.
  static bool is_doubtful(const std::vector<const PaintedView*>& views, const Texel& texel,
                          const std::vector<SeenFrom>& sightings) {
    if (!sightings.empty())
      return std::all_of(sightings.begin(), sightings.end(),
                         [](const SeenFrom& seen) { return seen.sighting.is_mixed; });
    return std::any_of(views.begin(), views.end(),
                       [&](const PaintedView* view) { return view->is_behind_edge(texel.p_base); });
  }

  void set(int x, int y, const Eigen::Vector3f& color) {
    const auto byte = [](float value) {
      return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
    };
    image_(x, y) = {byte(color.x()), byte(color.y()), byte(color.z())};
    is_known_(x, y) = 1;
  }

  const std::vector<TriangleMesh>& levels_;
  const std::vector<TextureCoordinates>& coordinates_;
  const Image<std::uint32_t>& triangles_;
  const std::vector<PaintedView>& views_;
  const TextureOptions& options_;
  ColorImage image_;
  MaskImage is_known_;
  MaskImage is_seen_;      ///< has a colour from an image
  MaskImage is_doubtful_;  ///< may have the colour of a nearer surface
};

bool has_surface_and_colors(const std::vector<TriangleMesh>& levels) {
  return !levels.empty() && std::none_of(levels.begin(), levels.end(), [](const TriangleMesh& m) {
    return m.triangles.empty() || m.colors.size() != m.vertices.size();
  });
}

/// Builds the views in parallel: `make` returns the view with this index.
template <typename Make>
std::vector<PaintedView> prepare(std::size_t count, Make make, Parallelism parallelism) {
  std::vector<std::optional<PaintedView>> prepared(count);
  parallel_for(parallelism, count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) prepared[i].emplace(make(i));
  });
  std::vector<PaintedView> result;
  for (std::optional<PaintedView>& view : prepared) result.push_back(std::move(*view));
  weigh_sharpness(result);
  return result;
}

/// Paints the atlas of the levels from views that agree with each other. Without size where it has
/// no room for the charts.
void paint_atlas(std::vector<TriangleMesh>& levels, std::vector<PaintedView>& painted,
                 const TextureOptions& options, Parallelism parallelism, MeshTexture& texture) {
  parallel_for(parallelism, painted.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) painted[i].set_surface(levels.front());
  });
  ChartSet set = make_charts(levels, parallelism);
  const AtlasLayout layout = lay_out(set, levels, painted, options);
  if (layout.height == 0) return;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    texture.coordinates.push_back(
        split_by_charts(levels[i], set.chart_of_triangle[i], set.charts, layout));
  }
  const Image<std::uint32_t> triangles = draw_triangles(levels, texture.coordinates, layout);
  AtlasPainter painter(levels, texture.coordinates, triangles, painted, options);
  painter.paint(parallelism);
  texture.image = painter.take_image();
  texture.seen_fraction = painter.seen_fraction();
  texture.views = painted.size();
  double area = 0.0;
  double texels = 0.0;
  for (const Chart& chart : set.charts) {
    area += static_cast<double>(chart.box.volume());
    texels += static_cast<double>(chart.box.volume() / (chart.texel * chart.texel));
  }
  texture.texel = texels > 0.0 ? std::sqrt(area / texels) : 0.0;
}

}  // namespace

MeshTexture paint_texture(std::vector<TriangleMesh>& levels_base,
                          const std::vector<TextureView>& views, const CameraModel& color_camera,
                          const DepthNoise& depth_noise, const TextureOptions& options,
                          Parallelism parallelism) {
  MeshTexture texture;
  texture.registration.camera = color_camera;
  if (views.empty() || !has_surface_and_colors(levels_base)) return texture;
  for (TriangleMesh& level : levels_base) {
    if (level.normals.empty()) compute_vertex_normals(level);
  }
  std::vector<PaintedView> painted = prepare(
      views.size(),
      [&](std::size_t i) {
        return PaintedView(views[i], texture.registration, depth_noise, options);
      },
      parallelism);
  texture.registration = align_colors(painted, levels_base.front(), texture.registration,
                                      options.register_color, parallelism);
  for (const PaintedView& view : painted) texture.exposures.push_back({view.gain, view.offset});
  paint_atlas(levels_base, painted, options, parallelism, texture);
  return texture;
}

MeshTexture paint_body(TriangleMesh& mesh_body, const std::vector<TextureView>& views,
                       const std::vector<BodyView>& seen_in, const MeshTexture& scene, int max_edge,
                       const DepthNoise& depth_noise, const TextureOptions& options,
                       Parallelism parallelism) {
  MeshTexture texture;
  texture.registration = scene.registration;
  std::vector<TriangleMesh> levels{mesh_body};
  if (seen_in.empty() || !has_surface_and_colors(levels)) return texture;
  std::vector<PaintedView> painted = prepare(
      seen_in.size(),
      [&](std::size_t i) {
        const auto& [index, T_body_camera] = seen_in[i];
        PaintedView view(views[index], T_body_camera, scene.registration, depth_noise, options);
        view.vignetting = static_cast<float>(scene.registration.vignetting);
        if (index < scene.exposures.size()) {
          view.gain = scene.exposures[index].gain;
          view.offset = scene.exposures[index].offset;
        }
        return view;
      },
      parallelism);
  TextureOptions limited = options;
  limited.atlas_width = std::min(options.atlas_width, max_edge);
  limited.atlas_height = std::min(options.atlas_height, max_edge);
  paint_atlas(levels, painted, limited, parallelism, texture);
  if (!texture.empty()) mesh_body = std::move(levels.front());
  return texture;
}

}  // namespace pcavr
