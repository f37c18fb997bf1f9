// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "atlas_packing.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace pcavr {
namespace {

/// The upper border of what is packed already, as segments from left to right.
class Skyline {
 public:
  Skyline(int width, int height) : width_(width), height_(height), segments_{{0, width, 0}} {}

  std::optional<Eigen::Vector2i> place(const Eigen::Vector2i& size) {
    std::optional<Eigen::Vector2i> best;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const int x = segments_[i].x;
      if (x + size.x() > width_) break;
      const int y = height_over(i, size.x());
      if (y + size.y() > height_ || (best && y >= best->y())) continue;
      best = Eigen::Vector2i(x, y);
    }
    if (best) raise(best->x(), size.x(), best->y() + size.y());
    return best;
  }

 private:
  struct Segment {
    int x;
    int width;
    int y;
  };

  [[nodiscard]] int height_over(std::size_t first, int width) const {
    const int end = segments_[first].x + width;
    int y = 0;
    for (std::size_t i = first; i < segments_.size() && segments_[i].x < end; ++i) {
      y = std::max(y, segments_[i].y);
    }
    return y;
  }

  void raise(int x, int width, int y) {
    std::vector<Segment> segments;
    bool is_inserted = false;
    const auto add = [&](const Segment& segment) {
      if (segment.width <= 0) return;
      if (!segments.empty() && segments.back().y == segment.y) {
        segments.back().width += segment.width;
      } else {
        segments.push_back(segment);
      }
    };
    for (const Segment& old : segments_) {
      const int end = old.x + old.width;
      add({old.x, std::min(end, x) - old.x, old.y});
      if (!is_inserted && end > x) {
        add({x, width, y});
        is_inserted = true;
      }
      const int begin = std::max(old.x, x + width);
      add({begin, end - begin, old.y});
    }
    segments_ = std::move(segments);
  }

  int width_;
  int height_;
  std::vector<Segment> segments_;
};

}  // namespace

std::optional<std::vector<Eigen::Vector2i>> pack_rectangles(
    const std::vector<Eigen::Vector2i>& sizes, int width, int height) {
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(sizes[a].y(), sizes[a].x()) > std::pair(sizes[b].y(), sizes[b].x());
  });
  Skyline skyline(width, height);
  std::vector<Eigen::Vector2i> corners(sizes.size());
  for (const std::size_t i : order) {
    const std::optional<Eigen::Vector2i> corner = skyline.place(sizes[i]);
    if (!corner) return std::nullopt;
    corners[i] = *corner;
  }
  return corners;
}

}  // namespace pcavr
