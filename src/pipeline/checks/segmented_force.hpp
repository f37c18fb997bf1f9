// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// A recording's force with its contacts, which are found by the force less its own level: a bias,
/// or a tool that turns, is not taken for a touch.
struct SegmentedForce {
  std::vector<double> t = {};               ///< [s] from the recording's start
  std::vector<Eigen::Vector3d> force = {};  ///< [N] as recorded
  Segmentation found = {};
};
[[nodiscard]] SegmentedForce segment_force(const Recording& recording);

}  // namespace pcavr
