// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {

/// The time between two samples of a stream that lie far apart [s]: the signal there is not known.
struct StreamGap {
  double begin = 0.0, end = 0.0;
};

/// The gaps in order of time; shorter intervals are interpolated. `t` [s] ascends.
[[nodiscard]] inline std::vector<StreamGap> stream_gaps(std::span<const double> t) {
  constexpr double kMinGap = 0.05;       // [s]
  constexpr double kMinIntervals = 4.0;  // [mean intervals] as streams have jitter
  std::vector<StreamGap> gaps;
  if (t.size() < 2) return gaps;
  const double min_gap = std::max(kMinGap, kMinIntervals * mean_interval(t));
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (t[i] - t[i - 1] > min_gap) gaps.push_back({t[i - 1], t[i]});
  }
  return gaps;
}

[[nodiscard]] inline bool is_in_gap(const std::vector<StreamGap>& gaps, double t) {
  return std::any_of(gaps.begin(), gaps.end(),
                     [t](const StreamGap& gap) { return t > gap.begin && t < gap.end; });
}

}  // namespace pcavr
