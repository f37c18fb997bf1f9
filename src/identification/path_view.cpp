// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/identification/path_view.hpp"

#include <algorithm>
#include <cstddef>

#include "pcavr/core/check.hpp"

namespace pcavr {

Eigen::Vector3d PathView::at(double t) const {
  PCAVR_REQUIRE(!t_.empty() && t_.size() == points_.size(), t_.size(), points_.size());
  const auto after = std::lower_bound(t_.begin(), t_.end(), t);
  if (after == t_.begin()) return points_.front();
  if (after == t_.end()) return points_.back();
  const auto i = static_cast<std::size_t>(after - t_.begin());
  const double share = (t - t_[i - 1]) / (t_[i] - t_[i - 1]);
  return points_[i - 1] + share * (points_[i] - points_[i - 1]);
}

}  // namespace pcavr
