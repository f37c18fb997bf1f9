// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"

namespace pcavr {

/// Findings name the column or joint as `place` and the row as `line`; `file` is left empty.

/// The model with the log's joints alone, in the log's order where that is the chain's order; all
/// others are locked at 0 (a gripper). Names are matched, without regard to letter case, `_` and
/// `-` where that is unambiguous; names that are all numbers count along the chain, from 0 or 1.
/// Fails where a name is not in the model, and where the log's columns are not in the order of the
/// chain and can't be brought into it.
struct MatchedRobot {
  RobotModel model;
  std::vector<std::size_t> columns;  ///< column of the log of each coordinate
  std::vector<std::string> notes;
};
[[nodiscard]] Expected<MatchedRobot> match_joints(const JointLog& log, const RobotModel& model);

/// The log's columns in this order.
[[nodiscard]] JointLog reordered(const JointLog& log, const std::vector<std::size_t>& columns);

struct LogFindings {
  std::vector<Error> errors;    ///< what must not be fitted
  std::vector<Error> warnings;  ///< what was repaired, left out, or could not be judged
};

/// Faults that rows show by themselves: jumps by full turns (unwrapped in `log`), other jumps,
/// positions that stand still while the joint moves, saturated torques, gaps, stamps of another
/// time, degrees in positions and velocities. The model has the log's joints in their order.
[[nodiscard]] LogFindings check_rows(JointLog& log, const RobotModel& model, double max_gap);

/// Whether each joint moves, at more than 0.01 rad/s rms. A joint that rests is held by its
/// friction, and its torque follows no model.
[[nodiscard]] std::vector<bool> moving_joints(const JointSignals& signals);

/// Faults that the torques show against the model, by comparing fits under hypotheses: degrees,
/// swapped columns, late torques, currents in place of torques, signs of single joints. The sign of
/// all torques together (load on the joint in place of the torque that drives it) is corrected in
/// `signals` and reported as a warning, as are the pairs of joints of which swapped columns would
/// not be found.
[[nodiscard]] LogFindings check_hypotheses(JointSignals& signals, const RobotModel& model);

}  // namespace pcavr
