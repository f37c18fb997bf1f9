// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/cycle_histogram.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr double kMinDuration = 0.25e-6;  // [s] end of the first bin; no cycle is shorter
constexpr double kBinsPerOctave = 8.0;

}  // namespace

CycleHistogram::CycleHistogram(std::uint32_t cycles_per_slice)
    : cycles_per_slice_(cycles_per_slice) {
  PCAVR_REQUIRE(cycles_per_slice >= 1);
}

std::size_t CycleHistogram::bin_of(double duration) noexcept {
  if (!(duration > kMinDuration)) return 0;
  const double bin = std::ceil(kBinsPerOctave * std::log2(duration / kMinDuration));
  return static_cast<std::size_t>(std::min(bin, static_cast<double>(kBins - 1)));
}

void CycleHistogram::Slice::add(std::size_t bin, double duration) noexcept {
  ++counts[bin];
  ++total;
  longest = std::max(longest, duration);
}

void CycleHistogram::add(double duration) noexcept {
  const std::size_t bin = bin_of(duration);
  slices_[slice_].add(bin, duration);
  all_.add(bin, duration);
  if (++in_slice_ >= cycles_per_slice_) close_slice();
}

double CycleHistogram::quantile(const Slice& slice, double fraction) noexcept {
  const double target = fraction * static_cast<double>(slice.total);
  double count = 0.0;
  // The last bin has no upper end.
  for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
    count += static_cast<double>(slice.counts[bin]);
    if (count < target) continue;
    const double middle = (static_cast<double>(bin) - 0.5) / kBinsPerOctave;
    return std::min(slice.longest, kMinDuration * std::exp2(middle));
  }
  return slice.longest;
}

CycleTimes CycleHistogram::times_of(const Slice& slice) noexcept {
  return {quantile(slice, 0.5), quantile(slice, 0.99), quantile(slice, 0.999), slice.longest};
}

void CycleHistogram::close_slice() noexcept {
  Slice sum;
  for (const Slice& slice : slices_) {
    for (std::size_t bin = 0; bin < kBins; ++bin) sum.counts[bin] += slice.counts[bin];
    sum.total += slice.total;
    sum.longest = std::max(sum.longest, slice.longest);
  }
  times_ = times_of(sum);
  slice_ = (slice_ + 1) % kSlices;
  slices_[slice_] = {};
  in_slice_ = 0;
}

}  // namespace pcavr
