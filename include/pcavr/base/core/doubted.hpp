// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace pcavr {

/// Stds of a disagreement up to which it is chance, as one in seven sound ones is larger, and from
/// which on it is none.
inline constexpr double kUsualStds = 1.5;
inline constexpr double kSignificantStds = 3.0;

/// What of a disagreement is to be added to stds, in its unit: nothing while it may be chance, and
/// from there on ever more, so that no result depends on which side of a threshold it is.
/// `stated_std` > 0.
[[nodiscard]] inline double doubted(double disagreement, double stated_std) {
  const double size = std::abs(disagreement);
  return size *
         std::clamp((size / stated_std - kUsualStds) / (kSignificantStds - kUsualStds), 0.0, 1.0);
}

}  // namespace pcavr
