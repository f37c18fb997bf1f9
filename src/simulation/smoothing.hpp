// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pcavr/base/geometry/image.hpp"

namespace pcavr::simulation {

/// Weights of a Gaussian at whole pixels, out to 3 sigma, with sum 1.
[[nodiscard]] inline std::vector<float> gaussian_kernel(double sigma) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<float> kernel;
  float sum = 0.0F;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(sigma > 0.0 ? static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)))
                                 : 1.0F);
    sum += kernel.back();
  }
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

/// Separable convolution of rows, then columns, with a kernel of odd length; the border is
/// reflected.
template <typename Pixel>
void smooth(Image<Pixel>& image, const std::vector<float>& kernel) {
  const int reach = static_cast<int>(kernel.size() / 2);
  const auto mirrored = [](int i, int size) {
    if (size == 1) return 0;
    while (i < 0 || i >= size) i = i < 0 ? -1 - i : 2 * size - 1 - i;
    return i;
  };
  const auto convolve = [&](int size, const auto& from, const auto& to) {
    for (int i = 0; i < size; ++i) {
      Pixel sum = kernel[static_cast<std::size_t>(reach)] * from(i);
      for (int k = 1; k <= reach; ++k) {
        const float weight = kernel[static_cast<std::size_t>(reach + k)];
        const bool is_inside = i >= k && i + k < size;
        const Pixel& before = from(is_inside ? i - k : mirrored(i - k, size));
        const Pixel& after = from(is_inside ? i + k : mirrored(i + k, size));
        sum += weight * (before + after);
      }
      to(i) = sum;
    }
  };
  Image<Pixel> rows = image;
  for (int y = 0; y < image.height(); ++y) {
    convolve(
        image.width(), [&](int x) -> const Pixel& { return image(x, y); },
        [&](int x) -> Pixel& { return rows(x, y); });
  }
  for (int x = 0; x < image.width(); ++x) {
    convolve(
        image.height(), [&](int y) -> const Pixel& { return rows(x, y); },
        [&](int y) -> Pixel& { return image(x, y); });
  }
}

}  // namespace pcavr::simulation
