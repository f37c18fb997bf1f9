// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/inputs/tip_path.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// A move of the tool during a gap of its recording. A straight line would push objects that stand
/// on it: the tip is taken to have gone up, over them and down again.
struct UnrecordedMove {
  double begin = 0.0, end = 0.0;  ///< [s]
  Eigen::Vector3d p_base_from, p_base_to;
};

/// Gaps in which the tip went much farther than at its speeds before and after: there its path is
/// not known. In order of time.
[[nodiscard]] std::vector<UnrecordedMove> find_unrecorded_moves(const TipPath& tip);

/// [m] Height in base at which the tip's centre passes over all objects.
[[nodiscard]] double height_over_objects(const TeleopInput& input);

/// Position of the tip's centre at `t` in [move.begin, move.end], at rest at both ends.
[[nodiscard]] Eigen::Vector3d p_base_over_objects(const UnrecordedMove& move, double height,
                                                  double t);

}  // namespace pcavr
