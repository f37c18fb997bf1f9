// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "robots/robot/spatial.hpp"

namespace pcavr::robot {

/// Cosines and sines of two angles.
struct TurnPair {
  Pair c;
  Pair s;
};

/// Sine and cosine of two angles, to 2e-16 for angles up to 1e5 rad; beyond, by the standard
/// functions, which are slower. The angle is reduced to [-pi/4, pi/4] by pi/2 in three parts [Cody
/// & Waite 1980]; there the first terms left out of the Taylor series are 1e-19 (sine, x^19/19!)
/// and 2e-18 (cosine, x^18/18!).
inline TurnPair turns_of(Pair angle) {
  // Beyond this the products with the parts of pi/2 are no longer exact.
  constexpr double kMaxAngle = 1e5;
  if (!(std::abs(angle[0]) < kMaxAngle && std::abs(angle[1]) < kMaxAngle)) {
    return {Pair{std::cos(angle[0]), std::cos(angle[1])},
            Pair{std::sin(angle[0]), std::sin(angle[1])}};
  }
  // pi/2 = the sum; the first two have 33 bits, so that their products with quarters are exact.
  constexpr double kHalfPi1 = 0x1.921fb544p+0;
  constexpr double kHalfPi2 = 0x1.0b4611a6p-34;
  constexpr double kHalfPi3 = 0x1.3198a2e037073p-69;
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  // Adding 1.5 * 2^52 rounds to an integer, which is then in the lowest bits.
  constexpr double kRounder = 0x1.8p+52;
  const Pair rounded = angle * kTwoOverPi + kRounder;
  const Pair quarters = rounded - kRounder;
  const Pair x = ((angle - quarters * kHalfPi1) - quarters * kHalfPi2) - quarters * kHalfPi3;
  const Pair xx = x * x;
  const Pair x4 = xx * xx;
  const Pair x8 = x4 * x4;
  // Estrin's scheme: short chains of dependent operations.
  const Pair sine_high = -1.0 / 1307674368000.0 + xx * (1.0 / 355687428096000.0);
  const Pair sine_tail = (-1.0 / 6.0 + xx * (1.0 / 120.0)) +
                         x4 * (-1.0 / 5040.0 + xx * (1.0 / 362880.0)) +
                         x8 * ((-1.0 / 39916800.0 + xx * (1.0 / 6227020800.0)) + x4 * sine_high);
  const Pair sine = x + x * xx * sine_tail;
  const Pair cosine_tail =
      (1.0 / 24.0 + xx * (-1.0 / 720.0)) + x4 * (1.0 / 40320.0 + xx * (-1.0 / 3628800.0)) +
      x8 * ((1.0 / 479001600.0 + xx * (-1.0 / 87178291200.0)) + x4 * (1.0 / 20922789888000.0));
  const Pair cosine = 1.0 - (0.5 * xx - x4 * cosine_tail);
  // Swaps and signs by bits: the quarter of a joint's angle is unpredictable for a branch.
  using Bits = std::uint64_t __attribute__((vector_size(16)));
  const auto quarter = std::bit_cast<Bits>(rounded);
  const Bits is_odd = -(quarter & 1);
  const auto sine_bits = std::bit_cast<Bits>(sine);
  const auto cosine_bits = std::bit_cast<Bits>(cosine);
  const Bits swapped = (sine_bits ^ cosine_bits) & is_odd;
  const Bits cosine_sign = ((quarter + 1) & 2) << 62;
  const Bits sine_sign = (quarter & 2) << 62;
  return {std::bit_cast<Pair>((cosine_bits ^ swapped) ^ cosine_sign),
          std::bit_cast<Pair>((sine_bits ^ swapped) ^ sine_sign)};
}

}  // namespace pcavr::robot
