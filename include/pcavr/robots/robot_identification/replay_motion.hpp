// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

/// Simulated positions beside the recorded ones.
struct SimulatedMotion {
  Eigen::MatrixXd position;  ///< [rad] row by row
  Eigen::VectorXd rms;       ///< [rad] error by joint, over the stretch
  Eigen::VectorXd kept;      ///< [s] by joint: within 3 degrees from the start on
  bool is_finite = false;    ///< false: the simulation diverged
};

/// One stretch of the log simulated from its first state under the recorded torques: torque in,
/// position out [paper A, section 4].
struct MotionReplay {
  std::vector<double> t;      ///< [s] of the log
  Eigen::MatrixXd recorded;   ///< [rad] positions, row by row
  SimulatedMotion simulated;  ///< all joints together
  SimulatedMotion alone;      ///< each joint alone, while the others follow the record [figure 3]
  Eigen::VectorXd after_1s;   ///< [rad] absolute error of all joints together 1 s after the start
  /// [N m] by joint: the constant error of its torque alone that moves some joint by 3 degrees rms
  /// over the stretch, linearised about the recorded motion. What a replay of this length asks for;
  /// at least 1e-6, which no sensor resolves.
  Eigen::VectorXd tolerable_torque;
};

/// Simulates from row `first` of the signals for `duration` [s], or to the end of the rows without
/// gaps. Torques are the log's, unfiltered, interpolated linearly; linearly implicit steps of at
/// most 0.5 ms.
[[nodiscard]] MotionReplay replay_motion(const JointLog& log, const JointSignals& signals,
                                         const RobotFit& fit, const RobotModel& model,
                                         std::size_t first, double duration);

}  // namespace pcavr
