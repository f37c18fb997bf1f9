// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pcavr/serve/live_world.hpp"

namespace pcavr {

/// Durations of the last second, and of all, in bins an eighth of an octave wide: a quantile is
/// right to 9 %. One thread; never allocates.
class CycleHistogram {
 public:
  /// `cycles_per_slice` >= 1 durations make a tenth of the window.
  explicit CycleHistogram(std::uint32_t cycles_per_slice);

  void add(double duration) noexcept;
  /// Of the last ten full slices; before the first is full, zeros.
  [[nodiscard]] const CycleTimes& times() const noexcept { return times_; }
  /// Of all that were added.
  [[nodiscard]] CycleTimes times_of_all() const noexcept { return times_of(all_); }

 private:
  static constexpr std::size_t kBins = 160;  ///< from 0.25 us on: 20 octaves, to 0.26 s
  static constexpr std::size_t kSlices = 10;
  struct Slice {
    void add(std::size_t bin, double duration) noexcept;
    std::array<std::uint32_t, kBins> counts{};
    std::uint32_t total = 0;
    double longest = 0.0;
  };

  [[nodiscard]] static std::size_t bin_of(double duration) noexcept;
  [[nodiscard]] static double quantile(const Slice& slice, double share) noexcept;
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
