// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace pcavr {

/// Seeded pseudo-random numbers, the same on every platform [Blackman & Vigna 2018, xoshiro256++,
/// seeded by splitmix64]. Not thread-safe; give each task its own (fork).
class Random {
 public:
  explicit Random(std::uint64_t seed);

  [[nodiscard]] std::uint64_t bits();
  /// Uniform in [0, 1).
  [[nodiscard]] double uniform();
  [[nodiscard]] double uniform(double low, double high);
  /// Uniform in [0, bound), bound >= 1.
  [[nodiscard]] std::uint64_t below(std::uint64_t bound);
  /// Standard normal, by Marsaglia's polar method.
  [[nodiscard]] double normal();
  /// An independent stream that depends on this one's seed and on `stream` only.
  [[nodiscard]] Random fork(std::uint64_t stream) const;

 private:
  std::uint64_t seed_;
  std::uint64_t state_[4];
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace pcavr
