// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace pcavr {

/// A cycle's time over the last second [s].
struct CycleTimes {
  double median = 0.0;
  double p99 = 0.0;
  double longest = 0.0;
};

/// Durations of the last second, in bins an eighth of an octave wide: a quantile is right to 9 %.
/// One thread; never allocates.
class CycleHistogram {
 public:
  /// `cycles_per_slice` >= 1 durations make a tenth of the window.
  explicit CycleHistogram(std::uint32_t cycles_per_slice);

  void add(double duration) noexcept;
  /// Of the last ten full slices; before the first is full, zeros.
  [[nodiscard]] const CycleTimes& times() const noexcept { return times_; }

 private:
  static constexpr std::size_t kBins = 160;  ///< from 0.25 us on: 20 octaves, to 0.26 s
  static constexpr std::size_t kSlices = 10;
  struct Slice {
    std::array<std::uint32_t, kBins> counts{};
    double longest = 0.0;
  };

  [[nodiscard]] static std::size_t bin_of(double duration) noexcept;
  [[nodiscard]] double quantile(double share, std::uint32_t total) const noexcept;
  void close_slice() noexcept;

  std::uint32_t cycles_per_slice_;
  std::uint32_t in_slice_ = 0;
  std::size_t slice_ = 0;
  std::array<Slice, kSlices> slices_{};
  std::array<std::uint32_t, kBins> sums_{};
  CycleTimes times_;
};

}  // namespace pcavr
