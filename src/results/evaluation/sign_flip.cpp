// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "pcavr/base/core/random.hpp"
#include "pcavr/results/evaluation/compare_runs.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxEnumerated = 16;           // 65 536 assignments
constexpr std::size_t kRandomAssignments = 100'000;  // p of 0.05 to 0.0007
constexpr std::uint64_t kSeed = 1;
/// Sums that differ by rounding count as equal.
constexpr double kSumRounding = 1e-9;

/// The sum with the sign of each difference by one bit.
double signed_sum(const std::vector<double>& differences, std::uint64_t signs) {
  double sum = 0.0;
  for (std::size_t i = 0; i < differences.size(); ++i)
    sum += (signs >> i & 1U) != 0U ? differences[i] : -differences[i];
  return sum;
}

double random_sum(const std::vector<double>& differences, Random& random) {
  double sum = 0.0;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    if (i % 64 == 0) bits = random.bits();
    sum += (bits >> i % 64 & 1U) != 0U ? differences[i] : -differences[i];
  }
  return sum;
}

}  // namespace

double sign_flip_p(const std::vector<double>& differences) {
  const double sum = std::accumulate(differences.begin(), differences.end(), 0.0);
  const double bound = std::abs(sum) * (1.0 - kSumRounding);
  std::size_t as_far = 0;
  if (differences.size() <= kMaxEnumerated) {
    const std::size_t all = std::size_t{1} << differences.size();
    for (std::size_t signs = 0; signs < all; ++signs)
      as_far += std::abs(signed_sum(differences, signs)) >= bound ? 1 : 0;
    return static_cast<double>(as_far) / static_cast<double>(all);
  }
  Random random(kSeed);
  for (std::size_t i = 0; i < kRandomAssignments; ++i)
    as_far += std::abs(random_sum(differences, random)) >= bound ? 1 : 0;
  return static_cast<double>(as_far + 1) / static_cast<double>(kRandomAssignments + 1);
}

std::vector<double> holm_adjusted(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p[i]; });
  std::vector<double> adjusted(p.size());
  double max = 0.0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const double factor = static_cast<double>(p.size() - rank);
    max = std::max(max, std::min(1.0, factor * p[order[rank]]));
    adjusted[order[rank]] = max;
  }
  return adjusted;
}

}  // namespace pcavr
