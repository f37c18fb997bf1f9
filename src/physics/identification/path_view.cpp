// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/path_view.hpp"

#include <algorithm>
#include <cstddef>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

Eigen::Vector3d PathView::at(double t) const {
  PCAVR_REQUIRE(!t_.empty() && t_.size() == points_.size(), t_.size(), points_.size());
  return before(static_cast<std::size_t>(std::lower_bound(t_.begin(), t_.end(), t) - t_.begin()),
                t);
}

Eigen::Vector3d PathView::at(double t, std::size_t& next) const {
  PCAVR_REQUIRE(!t_.empty() && t_.size() == points_.size(), t_.size(), points_.size());
  while (next < t_.size() && t_[next] < t) ++next;
  return before(next, t);
}

Eigen::Vector3d PathView::before(std::size_t after, double t) const {
  if (after == 0) return points_.front();
  if (after == t_.size()) return points_.back();
  const double share = (t - t_[after - 1]) / (t_[after] - t_[after - 1]);
  return points_[after - 1] + share * (points_[after] - points_[after - 1]);
}

}  // namespace pcavr
