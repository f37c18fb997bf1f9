// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/color_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/hashed_noise.hpp"
#include "simulation/smoothing.hpp"

namespace pcavr::simulation {

ColorImage expose(const ColorSensor& sensor, const Image<Eigen::Vector3f>& radiance,
                  std::uint64_t seed) {
  Image<Eigen::Vector3f> blurred = radiance;
  smooth(blurred, gaussian_kernel(sensor.blur));
  const int width = radiance.width();
  const int height = radiance.height();
  const float corner = 0.25F * static_cast<float>(width * width + height * height);
  const auto read_noise = static_cast<float>(sensor.read_noise);
  const auto shot_noise = static_cast<float>(sensor.shot_noise);
  ColorImage color(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float dx = static_cast<float>(x) - 0.5F * static_cast<float>(width - 1);
      const float dy = static_cast<float>(y) - 0.5F * static_cast<float>(height - 1);
      const float loss = static_cast<float>(sensor.vignetting) * (dx * dx + dy * dy) / corner;
      const auto pixel = static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint64_t>(x);
      const auto level = [&](int channel) {
        const float clean =
            blurred(x, y)[channel] * static_cast<float>(sensor.exposure) * (1.0F - loss);
        const float noise_std = read_noise + shot_noise * std::sqrt(std::max(0.0F, clean));
        const float noise =
            noise_std * normal_of(hash(seed, pixel, static_cast<std::uint64_t>(channel)));
        return static_cast<std::uint8_t>(std::clamp(clean + noise, 0.0F, 255.0F) + 0.5F);
      };
      color(x, y) = {level(0), level(1), level(2)};
    }
  }
  return color;
}

}  // namespace pcavr::simulation
