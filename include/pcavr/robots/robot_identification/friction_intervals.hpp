// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/robot_identification/options.cpp.
struct FrictionIntervalOptions {
  FrictionIntervalOptions();
  int intervals;       ///< of equal width, between the fitted rows' extreme positions
  double prior_share;  ///< std of an interval's values about the whole motion's, over these
};
[[nodiscard]] OptionSection section_of(FrictionIntervalOptions& options);

/// Friction within an interval of the joint's position.
struct FrictionInterval {
  double begin = 0.0;    ///< [rad]
  double end = 0.0;      ///< [rad]
  std::size_t rows = 0;  ///< fitted ones within
  /// Offset [N m], viscous friction [N m s/rad], Coulomb friction [N m], with std.
  std::vector<FittedTerm> terms;
};

/// Paper A's table: friction that differs by joint position. The first and the last interval are
/// valid beyond their ends, too.
struct JointIntervals {
  std::vector<FrictionInterval> intervals;
  TorqueError train, held_out;  ///< with the table in place of the joint's single values
};

/// Offset, viscous and Coulomb friction of each joint by interval of its position, least squares
/// about `fit`'s values for the whole motion; its further terms stay. An interval with few rows
/// keeps the values of the whole. By joint, in order. Pure function.
[[nodiscard]] std::vector<JointIntervals> friction_by_interval(
    const JointSignals& signals, const RobotModel& described, const RobotFit& fit,
    const FrictionIntervalOptions& options = {});

}  // namespace pcavr
