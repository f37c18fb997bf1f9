// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/local_direction.hpp"

#include <cstddef>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {

LocalContact along_local_force(std::span<const double> t,
                               std::span<const Eigen::Vector3d> force_base, const PathView& tip,
                               double half_width) {
  PCAVR_REQUIRE(t.size() == force_base.size());
  LocalContact contact{.t = t, .tool = {}, .force = {}};
  const std::vector<bool> all(t.size(), true);
  std::vector<Eigen::Vector3d> direction = track_bias(t, force_base, all, half_width);
  for (Eigen::Vector3d& one : direction) one.normalize();
  double path = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (i > 0) {
      const Eigen::Vector3d step = tip.at(t[i]) - tip.at(t[i - 1]);
      path += 0.5 * step.dot(direction[i] + direction[i - 1]);
    }
    contact.tool.push_back(path);
    contact.force.push_back(force_base[i].dot(direction[i]));
  }
  return contact;
}

}  // namespace pcavr
