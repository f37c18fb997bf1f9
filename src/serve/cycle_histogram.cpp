// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "cycle_histogram.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"

namespace pcavr {
namespace {

constexpr double kLeast = 0.25e-6;  // [s] what the first bin ends with; no cycle is shorter
constexpr double kBinsPerOctave = 8.0;

}  // namespace

CycleHistogram::CycleHistogram(std::uint32_t cycles_per_slice)
    : cycles_per_slice_(cycles_per_slice) {
  PCAVR_REQUIRE(cycles_per_slice >= 1);
}

std::size_t CycleHistogram::bin_of(double duration) noexcept {
  if (!(duration > kLeast)) return 0;
  const double place = std::ceil(kBinsPerOctave * std::log2(duration / kLeast));
  return static_cast<std::size_t>(std::min(place, static_cast<double>(kBins - 1)));
}

void CycleHistogram::add(double duration) noexcept {
  Slice& slice = slices_[slice_];
  ++slice.counts[bin_of(duration)];
  slice.longest = std::max(slice.longest, duration);
  if (++in_slice_ >= cycles_per_slice_) close_slice();
}

double CycleHistogram::quantile(double share, std::uint32_t total) const noexcept {
  const double wanted = share * static_cast<double>(total);
  double seen = 0.0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += static_cast<double>(sums_[bin]);
    if (seen >= wanted) return kLeast * std::exp2(static_cast<double>(bin) / kBinsPerOctave);
  }
  return times_.longest;
}

void CycleHistogram::close_slice() noexcept {
  std::uint32_t total = 0;
  double longest = 0.0;
  sums_.fill(0);
  for (const Slice& slice : slices_) {
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      sums_[bin] += slice.counts[bin];
      total += slice.counts[bin];
    }
    longest = std::max(longest, slice.longest);
  }
  times_.longest = longest;
  times_.median = std::min(longest, quantile(0.5, total));
  times_.p99 = std::min(longest, quantile(0.99, total));
  slice_ = (slice_ + 1) % kSlices;
  slices_[slice_] = {};
  in_slice_ = 0;
}

}  // namespace pcavr
