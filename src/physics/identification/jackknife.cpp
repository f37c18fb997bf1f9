// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/jackknife.hpp"

#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

/// Student's distribution over the normal one: its std, and with one or two degrees of freedom,
/// where that is infinite, the ratio of their 95 % quantiles.
double student_factor(double freedom) {
  constexpr double kOfOne = 6.5, kOfTwo = 2.2;
  if (freedom < 1.5) return kOfOne;
  return freedom < 2.5 ? kOfTwo : std::sqrt(freedom / (freedom - 2.0));
}

}  // namespace

double jackknife_std(std::span<const double> without_group) {
  PCAVR_REQUIRE(without_group.size() >= 2, without_group.size());
  const auto count = static_cast<double>(without_group.size());
  double mean = 0.0, squares = 0.0;
  for (const double value : without_group) mean += value / count;
  for (const double value : without_group) squares += (value - mean) * (value - mean);
  return std::sqrt((count - 1.0) / count * squares) * student_factor(count - 1.0);
}

}  // namespace pcavr
