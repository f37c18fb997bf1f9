// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/core/expected.hpp"
#include "pcavr/recording/joint_log.hpp"
#include "pcavr/robot/robot_model.hpp"
#include "pcavr/robot_identification/joint_signals.hpp"

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
/// positions that stand still while the joint moves, saturated torques, gaps, degrees in positions
/// and velocities. The model
/// has the log's joints in their order.
[[nodiscard]] LogFindings check_rows(JointLog& log, const RobotModel& model, double max_gap);

/// Faults that the torques show against the model, by comparing fits under hypotheses: degrees,
/// swapped columns, late torques, currents in place of torques, signs of single joints. The sign of
/// all torques together (load on the joint in place of the torque that drives it) is corrected in
/// `signals` and reported as a warning, as are the pairs of joints of which swapped columns would
/// not be found.
[[nodiscard]] LogFindings check_hypotheses(JointSignals& signals, const RobotModel& model);

}  // namespace pcavr
