// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "exposure.hpp"

#include <algorithm>
#include <cstddef>

#include "vignetting.hpp"

namespace pcavr {
namespace {

using Color = Eigen::Array3d;

constexpr int kRounds = 3;
/// The prior counts as this number of points that agree: views that share few points keep their
/// exposure.
constexpr double kPriorPoints = 50.0;
constexpr double kPriorLevel = 100.0;  ///< their colour, of 255
constexpr double kPriorStd = 30.0;     ///< and its contrast
/// This share of the points counts as having the prior's contrast: a single colour says nothing
/// about the contrast.
constexpr double kPriorShare = 0.1;
/// Shadows, highlights and moved things differ by more [of 255], once the gains are right.
constexpr double kMaxDifference = 25.0;
constexpr double kMaxRatio = 1.4;  ///< and before
constexpr double kBlack = 8.0;     ///< whatever the exposure

/// First and second moments of a view's colours, and of the median over the views at these points.
struct Moments {
  double count = 0.0;
  Color own = Color::Zero();
  Color own_square = Color::Zero();
  Color median = Color::Zero();
  Color median_square = Color::Zero();

  void add(const Color& own_color, const Color& median_color) {
    count += 1.0;
    own += own_color;
    own_square += own_color.square();
    median += median_color;
    median_square += median_color.square();
  }
};

/// A point's colour in a view.
struct Sample {
  std::uint32_t view = 0;
  Color color;
};

/// The median by channel: a shadow in a minority of the views does not count.
Color median_of(std::vector<Sample>& samples) {
  Color median;
  for (int channel = 0; channel < 3; ++channel) {
    std::sort(samples.begin(), samples.end(), [&](const Sample& a, const Sample& b) {
      return a.color[channel] < b.color[channel];
    });
    const std::size_t middle = samples.size() / 2;
    median[channel] = 0.5 * (samples[middle].color[channel] +
                             samples[samples.size() - 1 - middle].color[channel]);
  }
  return median;
}

/// Looks the colours up once for all rounds: gains, offsets and vignetting do not change where a
/// point is in an image.
SeenColors look_up_colors(const std::vector<PaintedView>& views,
                          const std::vector<SeenPoint>& points, Parallelism parallelism) {
  constexpr std::size_t kPointsPerTask = 500;
  SeenColors colors(points.size());
  parallel_for(parallelism, points.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (const std::uint32_t view : points[i].views) {
        const auto pixel = views[view].exposed_pixel(points[i].p_base);
        if (pixel) colors[i].push_back({view, views[view].raw_color_at(*pixel)});
      }
    }
  });
  return colors;
}

void collect(const std::vector<SeenColor>& point, const std::vector<PaintedView>& views,
             std::vector<Sample>& samples) {
  samples.clear();
  for (const auto& [view, raw] : point)
    samples.push_back({view, views[view].evened_out(raw).cast<double>().array()});
}

bool agrees(const Color& own, const Color& median, bool with_offset) {
  if (with_offset) return (own - median).abs().maxCoeff() < kMaxDifference;
  const Color ratio = median / own.max(4.0);
  return ratio.minCoeff() > 1.0 / kMaxRatio && ratio.maxCoeff() < kMaxRatio;
}

/// The moments of each view at the points that other views see as well.
std::vector<Moments> moments_of(const std::vector<PaintedView>& views, const SeenColors& points,
                                bool with_offset) {
  std::vector<Moments> moments(views.size());
  std::vector<Sample> samples;
  for (const std::vector<SeenColor>& point : points) {
    collect(point, views, samples);
    if (samples.size() < 2) continue;
    const Color median = median_of(samples);
    if (median.minCoeff() < kBlack) continue;
    for (const auto& [i, color] : samples) {
      if (agrees(color, median, with_offset)) moments[i].add(color, median);
    }
  }
  return moments;
}

/// Equalises the means by the gain alone, or means and variances by gain and offset: a regression
/// would lower the contrast of a view that lies a little beside the others.
void adjust(PaintedView& view, const Moments& m, bool with_offset) {
  const double n = std::max(1.0, m.count);
  Color gain = (m.median + kPriorPoints * kPriorLevel) / (m.own + kPriorPoints * kPriorLevel);
  Color offset = Color::Zero();
  if (with_offset) {
    const double prior = (kPriorPoints + kPriorShare * n) * kPriorStd * kPriorStd;
    const Color variance = (m.own_square - m.own.square() / n).max(0.0) + prior;
    gain = (((m.median_square - m.median.square() / n).max(0.0) + prior) / variance).sqrt();
    offset = (m.median - gain * m.own) / (n + kPriorPoints);
  }
  view.gain = view.gain.array() * gain.cast<float>();
  view.offset = gain.cast<float>() * view.offset.array() + offset.cast<float>();
}

void normalise(std::vector<PaintedView>& views) {
  const auto count = static_cast<float>(views.size());
  Eigen::Array3f log_gain = Eigen::Array3f::Zero();
  for (const PaintedView& view : views) log_gain += view.gain.array().log() / count;
  const Eigen::Vector3f common = log_gain.exp();
  Eigen::Vector3f mean_offset = Eigen::Vector3f::Zero();
  for (PaintedView& view : views) {
    view.gain = view.gain.cwiseQuotient(common);
    view.offset = view.offset.cwiseQuotient(common);
    mean_offset += view.offset / count;
  }
  for (PaintedView& view : views) view.offset -= mean_offset;
}

}  // namespace

void even_out_exposures(std::vector<PaintedView>& views, const std::vector<SeenPoint>& points,
                        Parallelism parallelism) {
  const SeenColors colors = look_up_colors(views, points, parallelism);
  for (const bool with_offset : {false, true}) {
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<Moments> moments = moments_of(views, colors, with_offset);
      for (std::size_t i = 0; i < views.size(); ++i) adjust(views[i], moments[i], with_offset);
      normalise(views);
    }
    if (!with_offset) estimate_vignetting(views, colors);
  }
}

}  // namespace pcavr
