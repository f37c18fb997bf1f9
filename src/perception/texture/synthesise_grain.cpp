// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "synthesise_grain.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

constexpr int kSmooth = 5;  ///< [px] radius of the mean that the grain is the difference from
/// Of the grain's robust std: a larger difference is a shadow's or a print's edge.
constexpr float kStep = 2.5F;
constexpr int kRing = 4;              ///< [px] around a gap, where the grain is compared
constexpr int kMaxOffset = 80;        ///< [px] along each axis
constexpr float kMinCompared = 0.6F;  ///< share of the ring that has to be known at the offset
constexpr float kMaxContrast =
    2.0F;  ///< grain's square at the offset over that of the ring: a print, not grain

using Pixel = Eigen::Vector2i;
using Grain = Image<Eigen::Vector3f>;

Eigen::Vector3f vector_of(const Rgb8& c) { return {float(c.r), float(c.g), float(c.b)}; }

/// The known pixels' difference from the mean of the known ones around them.
Grain grain_of(const ColorImage& image, const MaskImage& is_known) {
  // Sums of colours over a row, then over a column, with counts in the last element.
  using Sums = Image<Eigen::Vector4f>;
  Sums sums(image.width(), image.height(), Eigen::Vector4f::Zero());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (is_known(x, y) != 0) sums(x, y) << vector_of(image(x, y)), 1.0F;
    }
  }
  for (const Pixel& along : {Pixel(1, 0), Pixel(0, 1)}) {
    Sums next(image.width(), image.height(), Eigen::Vector4f::Zero());
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        for (int i = -kSmooth; i <= kSmooth; ++i) {
          const Pixel at = Pixel(x, y) + i * along;
          if (sums.contains(at.x(), at.y())) next(x, y) += sums(at.x(), at.y());
        }
      }
    }
    sums = std::move(next);
  }
  Grain grain(image.width(), image.height(), Eigen::Vector3f::Zero());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Eigen::Vector4f& sum = sums(x, y);
      if (is_known(x, y) != 0) grain(x, y) = vector_of(image(x, y)) - sum.head<3>() / sum.w();
    }
  }
  return grain;
}

/// Standard deviation by the median, of the known pixels.
float robust_std(const Grain& grain, const MaskImage& is_known) {
  std::vector<double> sizes;
  for (int y = 0; y < grain.height(); ++y) {
    for (int x = 0; x < grain.width(); ++x) {
      if (is_known(x, y) != 0) sizes.push_back(static_cast<double>(grain(x, y).norm()));
    }
  }
  return static_cast<float>(kStdOverMad * median(std::move(sizes)));
}

/// The difference from the mean of the pixels around that differ by less than a step [Lee 1983]:
/// what is at a shadow's edge has the grain of its own side.
Grain grain_beside_steps(const ColorImage& image, const MaskImage& is_known, float step) {
  Grain grain(image.width(), image.height(), Eigen::Vector3f::Zero());
  const auto difference_at = [&](int x, int y) {
    const Eigen::Vector3f own = vector_of(image(x, y));
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float count = 0.0F;
    for (int at_y = std::max(0, y - kSmooth); at_y <= std::min(image.height() - 1, y + kSmooth);
         ++at_y) {
      for (int at_x = std::max(0, x - kSmooth); at_x <= std::min(image.width() - 1, x + kSmooth);
           ++at_x) {
        const Eigen::Vector3f other = vector_of(image(at_x, at_y));
        if (is_known(at_x, at_y) == 0 || (other - own).squaredNorm() > step * step) continue;
        sum += other;
        count += 1.0F;
      }
    }
    return Eigen::Vector3f(own - sum / count);
  };
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (is_known(x, y) != 0) grain(x, y) = difference_at(x, y);
    }
  }
  return grain;
}

/// A connected part of a mask.
std::vector<Pixel> take_part(MaskImage& mask, const Pixel& from) {
  std::vector<Pixel> part{from};
  mask(from.x(), from.y()) = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    for (const Pixel& step : {Pixel(1, 0), Pixel(-1, 0), Pixel(0, 1), Pixel(0, -1)}) {
      const Pixel at = part[i] + step;
      if (!mask.contains(at.x(), at.y()) || mask(at.x(), at.y()) == 0) continue;
      mask(at.x(), at.y()) = 0;
      part.push_back(at);
    }
  }
  return part;
}

/// The known pixels around a part.
std::vector<Pixel> ring_of(const std::vector<Pixel>& part, const MaskImage& is_known) {
  MaskImage is_near(is_known.width(), is_known.height());
  for (const Pixel& p : part) {
    for (int y = std::max(0, p.y() - kRing); y <= std::min(is_near.height() - 1, p.y() + kRing);
         ++y)
      for (int x = std::max(0, p.x() - kRing); x <= std::min(is_near.width() - 1, p.x() + kRing);
           ++x)
        is_near(x, y) = is_known(x, y);
  }
  std::vector<Pixel> ring;
  for (int y = 0; y < is_near.height(); ++y) {
    for (int x = 0; x < is_near.width(); ++x) {
      if (is_near(x, y) != 0) ring.emplace_back(x, y);
    }
  }
  return ring;
}

class Continuation {
 public:
  Continuation(const Grain& grain, const MaskImage& is_known, const std::vector<Pixel>& part)
      : grain_(grain), is_known_(is_known), part_(part), ring_(ring_of(part, is_known)) {}

  [[nodiscard]] std::optional<Pixel> best_offset() const {
    const float contrast = mean_square(ring_, Pixel::Zero());
    std::optional<Pixel> best;
    float least = 0.0F;
    for (int dy = -kMaxOffset; dy <= kMaxOffset; ++dy) {
      for (int dx = -kMaxOffset; dx <= kMaxOffset; ++dx) {
        const Pixel offset(dx, dy);
        const bool is_all_known = std::all_of(
            part_.begin(), part_.end(), [&](const Pixel& p) { return is_known_at(p + offset); });
        if (!is_all_known || mean_square(part_, offset) > kMaxContrast * contrast) continue;
        const std::optional<float> difference = difference_at(offset);
        if (!difference || (best && *difference >= least)) continue;
        best = offset;
        least = *difference;
      }
    }
    return best;
  }

 private:
  [[nodiscard]] bool is_known_at(const Pixel& p) const {
    return is_known_.contains(p.x(), p.y()) && is_known_(p.x(), p.y()) != 0;
  }

  [[nodiscard]] float mean_square(const std::vector<Pixel>& pixels, const Pixel& offset) const {
    float sum = 0.0F;
    for (const Pixel& p : pixels)
      sum += grain_(p.x() + offset.x(), p.y() + offset.y()).squaredNorm();
    return sum / static_cast<float>(std::max<std::size_t>(1, pixels.size()));
  }

  /// Mean squared difference of the ring's grain from that at the offset.
  [[nodiscard]] std::optional<float> difference_at(const Pixel& offset) const {
    float sum = 0.0F;
    float count = 0.0F;
    for (const Pixel& p : ring_) {
      const Pixel from = p + offset;
      if (!is_known_at(from)) continue;
      sum += (grain_(p.x(), p.y()) - grain_(from.x(), from.y())).squaredNorm();
      count += 1.0F;
    }
    if (!(count > kMinCompared * static_cast<float>(ring_.size()))) return std::nullopt;
    return sum / count;
  }

  const Grain& grain_;
  const MaskImage& is_known_;
  const std::vector<Pixel>& part_;
  std::vector<Pixel> ring_;
};

}  // namespace

void synthesise_grain(ColorImage& image, const MaskImage& is_known, const MaskImage& is_gap) {
  const float std = robust_std(grain_of(image, is_known), is_known);
  const Grain grain = grain_beside_steps(image, is_known, kStep * std);
  MaskImage left = is_gap;
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) left(x, y) = is_known(x, y) != 0 ? 0 : left(x, y);
  }
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
  };
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      if (left(x, y) == 0) continue;
      const std::vector<Pixel> part = take_part(left, {x, y});
      const std::optional<Pixel> offset = Continuation(grain, is_known, part).best_offset();
      if (!offset) continue;
      for (const Pixel& p : part) {
        const Eigen::Vector3f color =
            vector_of(image(p.x(), p.y())) + grain(p.x() + offset->x(), p.y() + offset->y());
        image(p.x(), p.y()) = {byte(color.x()), byte(color.y()), byte(color.z())};
      }
    }
  }
}

}  // namespace pcavr
