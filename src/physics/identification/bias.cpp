// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {

std::vector<Eigen::Vector3d> track_bias(std::span<const double> t,
                                        std::span<const Eigen::Vector3d> force,
                                        const std::vector<bool>& is_free, double half_width) {
  PCAVR_REQUIRE(t.size() == force.size() && t.size() == is_free.size());
  PCAVR_REQUIRE(half_width > 0.0, half_width);
  const std::size_t count = t.size();
  std::vector<Eigen::Vector3d> bias(count, Eigen::Vector3d::Zero());
  std::vector<std::size_t> known;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t begin = 0, end = 0, free = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (; end < count && t[end] <= t[i] + half_width; ++end) {
      if (is_free[end]) sum += force[end], ++free;
    }
    for (; t[begin] < t[i] - half_width; ++begin) {
      if (is_free[begin]) sum -= force[begin], --free;
    }
    if (!is_free[i]) continue;
    bias[i] = sum / static_cast<double>(free);
    known.push_back(i);
  }
  if (known.empty()) return bias;
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_free[i]) continue;
    while (next < known.size() && known[next] < i) ++next;
    const std::size_t after = known[std::min(next, known.size() - 1)];
    const std::size_t before = known[next > 0 ? next - 1 : 0];
    const double span = t[after] - t[before];
    const double share = span > 0.0 ? (t[i] - t[before]) / span : 0.0;
    bias[i] = bias[before] + std::clamp(share, 0.0, 1.0) * (bias[after] - bias[before]);
  }
  return bias;
}

}  // namespace pcavr
