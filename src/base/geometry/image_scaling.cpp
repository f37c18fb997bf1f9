// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/image_scaling.hpp"

#include <cstdint>

namespace pcavr {

ColorImage halved(const ColorImage& image) {
  ColorImage half(image.width() / 2, image.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      const auto mean = [&](std::uint8_t Rgb8::*channel) {
        const int sum = image(2 * x, 2 * y).*channel + image(2 * x + 1, 2 * y).*channel +
                        image(2 * x, 2 * y + 1).*channel + image(2 * x + 1, 2 * y + 1).*channel;
        return static_cast<std::uint8_t>((sum + 2) / 4);
      };
      half(x, y) = {mean(&Rgb8::r), mean(&Rgb8::g), mean(&Rgb8::b)};
    }
  }
  return half;
}

}  // namespace pcavr
