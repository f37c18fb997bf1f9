// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "marker/random_layout.hpp"

namespace pcavr::test {

/// Errors of a layout's tags against their stds, over random layouts with different noise.
struct LayoutCoverage {
  double percent = 0.0;  ///< within one std
  double largest = 0.0;  ///< [stds]
};

inline LayoutCoverage layout_coverage(std::uint64_t first_seed, std::uint64_t rigs) {
  LayoutCoverage coverage;
  int within = 0, all = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + rigs; ++seed) {
    const double corner_std = seed % 3 == 0 ? 0.05 : seed % 3 == 1 ? 0.2 : 0.5;
    const RandomLayout rig(seed, {.tags = 3 + static_cast<int>(seed % 3),
                                  .views = 15 + static_cast<int>(seed % 20),
                                  .corner_std = corner_std});
    const auto found = solve_tag_layout(rig.with_stated(1), rig.frames, a_camera());
    if (!found || found->tags.size() < rig.tags.size()) {
      ADD_FAILURE() << "rig " << seed << " has no layout";
      continue;
    }
    for (std::size_t i = 1; i < rig.tags.size(); ++i) {
      const LaidOutTag& tag = found->tags[i];
      const Vector6d error = (tag.T_body_tag.inverse() * *rig.tags[i].T_body_tag).log();
      for (Eigen::Index axis = 0; axis < 6; ++axis) {
        const double ratio = std::abs(error[axis]) / std::sqrt(tag.covariance(axis, axis));
        within += ratio < 1.0 ? 1 : 0;
        coverage.largest = std::max(coverage.largest, ratio);
        ++all;
      }
    }
  }
  coverage.percent = 100.0 * within / std::max(1, all);
  return coverage;
}

}  // namespace pcavr::test
