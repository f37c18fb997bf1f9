// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace pcavr {

/// Quantiles of the cycles' durations [s].
struct CycleTimes {
  double median = 0.0;
  double p99 = 0.0;
  double p999 = 0.0;
  double longest = 0.0;
};

/// Histogram of durations over a sliding window of one second, and over all, with logarithmic bins
/// an eighth of an octave wide. A quantile, the smallest duration that at least this fraction of
/// all do not exceed, is given as the middle of its bin: an error of at most half a bin (4.4 %),
/// from 0.25 us to 0.22 s. If it is longer, the longest duration is given. One thread; never
/// allocates.
class CycleHistogram {
 public:
  /// `cycles_per_slice` >= 1: number of durations in a tenth of the window.
  explicit CycleHistogram(std::uint32_t cycles_per_slice);

  void add(double duration) noexcept;
  /// The quantiles over the last ten full slices; zeros before the first is full.
  [[nodiscard]] const CycleTimes& times() const noexcept { return times_; }
  /// The quantiles over all durations that were added.
  [[nodiscard]] CycleTimes times_of_all() const noexcept { return times_of(all_); }

 private:
  static constexpr std::size_t kBins = 160;  ///< up to 0.25 us, then 158 up to 0.22 s, and longer
  static constexpr std::size_t kSlices = 10;
  struct Slice {
    void add(std::size_t bin, double duration) noexcept;
    std::array<std::uint32_t, kBins> counts{};
    std::uint32_t total = 0;
    double longest = 0.0;
  };

  [[nodiscard]] static std::size_t bin_of(double duration) noexcept;
  [[nodiscard]] static double quantile(const Slice& slice, double fraction) noexcept;
  [[nodiscard]] static CycleTimes times_of(const Slice& slice) noexcept;
  void close_slice() noexcept;

  std::uint32_t cycles_per_slice_;
  std::uint32_t in_slice_ = 0;
  std::size_t slice_ = 0;
  std::array<Slice, kSlices> slices_{};
  Slice all_;
  CycleTimes times_;
};

}  // namespace pcavr
