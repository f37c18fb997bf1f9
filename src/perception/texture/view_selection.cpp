// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/texture/view_selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

namespace pcavr {
namespace {

int luma_of(const Rgb8& color) { return (2 * color.r + 5 * color.g + color.b) / 8; }

}  // namespace

double sharpness_of(const ColorImage& color) {
  std::int64_t sum = 0;
  std::int64_t count = 0;
  // Every fourth row: neighbouring rows say the same.
  for (int y = 0; y + 1 < color.height(); y += 4) {
    const std::span<const Rgb8> row = color.row(y);
    const std::span<const Rgb8> below = color.row(y + 1);
    for (std::size_t x = 0; x + 1 < row.size(); ++x) {
      const int own = luma_of(row[x]);
      sum += std::abs(luma_of(row[x + 1]) - own) + std::abs(luma_of(below[x]) - own);
      ++count;
    }
  }
  return count == 0 ? 0.0 : static_cast<double>(sum) / static_cast<double>(count);
}

ViewSelection::ViewSelection(const TextureOptions& options) : options_(options) {}

bool ViewSelection::are_near(const ViewCandidate& a, const ViewCandidate& b, double scale) const {
  const double seconds = std::abs(to_seconds(a.stamp - b.stamp));
  return seconds <= scale * options_.view_interval &&
         translation_distance(a.T_base_camera, b.T_base_camera) <=
             scale * options_.view_translation &&
         rotation_distance(a.T_base_camera, b.T_base_camera) <= scale * options_.view_rotation;
}

void ViewSelection::add(std::size_t frame, Stamp stamp, const Pose& T_base_camera,
                        const ColorImage& color, const DepthImage& depth,
                        const MaskImage& is_dynamic) {
  ViewCandidate candidate{.frame = frame,
                          .stamp = stamp,
                          .T_base_camera = T_base_camera,
                          .sharpness = sharpness_of(color),
                          .is_dynamic = {},
                          .color = {},
                          .depth = {}};
  const bool is_near = !candidates_.empty() && are_near(candidates_.back(), candidate, scale_);
  if (is_near && candidates_.back().sharpness >= candidate.sharpness) return;
  const std::span<const std::uint8_t> mask = is_dynamic.pixels();
  if (std::any_of(mask.begin(), mask.end(), [](std::uint8_t pixel) { return pixel != 0; })) {
    candidate.is_dynamic = is_dynamic;
  }
  if (is_near) candidates_.pop_back();
  candidates_.push_back(std::move(candidate));
  keep_images(color, depth);
  if (candidates_.size() > 2 * static_cast<std::size_t>(options_.max_views)) {
    scale_ *= 2.0;
    thin_out();
  }
}

void ViewSelection::keep_images(const ColorImage& color, const DepthImage& depth) {
  if (!keeps_images_) return;
  const std::size_t bytes = color.pixels().size_bytes() + depth.pixels().size_bytes();
  keeps_images_ = candidates_.size() * bytes <= max_memory();
  if (keeps_images_) {
    candidates_.back().color = color;
    candidates_.back().depth = depth;
    return;
  }
  for (ViewCandidate& candidate : candidates_) {
    candidate.color = {};
    candidate.depth = {};
  }
}

void ViewSelection::thin_out() {
  std::vector<ViewCandidate> kept;
  for (ViewCandidate& candidate : candidates_) {
    if (kept.empty() || !are_near(kept.back(), candidate, scale_)) {
      kept.push_back(std::move(candidate));
    } else if (candidate.sharpness > kept.back().sharpness) {
      kept.back() = std::move(candidate);
    }
  }
  candidates_ = std::move(kept);
}

std::size_t ViewSelection::max_memory() const {
  return static_cast<std::size_t>(options_.max_view_memory) << 20U;
}

std::vector<ViewCandidate> ViewSelection::take_chosen(std::size_t bytes_per_view) {
  const std::size_t fitting =
      std::max<std::size_t>(1, max_memory() / std::max<std::size_t>(1, bytes_per_view));
  const std::size_t count = std::min(fitting, static_cast<std::size_t>(options_.max_views));
  std::vector<ViewCandidate> candidates = std::exchange(candidates_, {});
  if (candidates.size() <= count) return candidates;
  // The sharpest of consecutive candidates is taken, evenly along the path.
  std::vector<ViewCandidate> views;
  for (std::size_t i = 0; i < count; ++i) {
    const auto begin =
        candidates.begin() + static_cast<std::ptrdiff_t>(i * candidates.size() / count);
    const auto end =
        candidates.begin() + static_cast<std::ptrdiff_t>((i + 1) * candidates.size() / count);
    views.push_back(std::move(*std::max_element(
        begin, end, [](const auto& a, const auto& b) { return a.sharpness < b.sharpness; })));
  }
  return views;
}

}  // namespace pcavr
