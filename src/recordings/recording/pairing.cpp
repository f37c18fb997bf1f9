// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/pairing.hpp"

namespace pcavr {
namespace {

Duration time_difference(Stamp a, Stamp b) { return a > b ? a - b : b - a; }

/// The index of the nearest stamp in `to`, which is not empty, for each stamp of `from`.
std::vector<std::size_t> nearest_indices(std::span<const Stamp> from, std::span<const Stamp> to) {
  std::vector<std::size_t> nearest;
  nearest.reserve(from.size());
  std::size_t candidate = 0;
  for (const Stamp stamp : from) {
    while (candidate + 1 < to.size() &&
           time_difference(to[candidate + 1], stamp) < time_difference(to[candidate], stamp)) {
      ++candidate;
    }
    nearest.push_back(candidate);
  }
  return nearest;
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> pair_by_time(std::span<const Stamp> a,
                                                              std::span<const Stamp> b,
                                                              Duration max_gap) {
  if (a.empty() || b.empty()) return {};
  const std::vector<std::size_t> nearest_b = nearest_indices(a, b);
  const std::vector<std::size_t> nearest_a = nearest_indices(b, a);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t j = nearest_b[i];
    if (nearest_a[j] == i && time_difference(a[i], b[j]) <= max_gap) pairs.emplace_back(i, j);
  }
  return pairs;
}

}  // namespace pcavr
