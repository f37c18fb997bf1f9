// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace pcavr::simulation {

/// Counter-based random numbers: a hash of seed, stream, frame and pixel, so that a pixel's noise
/// does not depend on the thread. The mixer is splitmix64's [Steele et al. 2014].
[[nodiscard]] inline std::uint64_t hash(std::uint64_t a, std::uint64_t b, std::uint64_t c = 0) {
  std::uint64_t z = a * 0x9e3779b97f4a7c15ULL + b * 0xd1342543de82ef95ULL + c + 1;
  for (int round = 0; round < 2; ++round) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
  }
  return z;
}

/// Uniform in [0, 1).
[[nodiscard]] inline float uniform_of(std::uint64_t word) {
  return static_cast<float>(word >> 40) * 0x1.0p-24F;
}

/// Approximately standard normal: the sum of four 16-bit uniforms (Irwin-Hall). Mean 0 and variance
/// 1 are exact; nothing lies beyond 3.46, where a normal would have 1 in 1900.
[[nodiscard]] inline float normal_of(std::uint64_t word) {
  const std::uint64_t sum =
      (word & 0xffff) + ((word >> 16) & 0xffff) + ((word >> 32) & 0xffff) + (word >> 48);
  constexpr float kScale = 1.7320508F / 65536.0F;  // sqrt(12 / 4) per unit
  return (static_cast<float>(sum) - 131070.0F) * kScale;
}

}  // namespace pcavr::simulation
