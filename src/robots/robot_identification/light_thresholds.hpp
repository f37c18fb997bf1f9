// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/robots/robot_identification/contact_observer.hpp"

#include "robots/robot_identification/observed_rows.hpp"

namespace pcavr {

/// The inputs from which the thresholds of the filtered torques are computed.
struct LightThresholdInput {
  const JointLog& log;
  const Eigen::MatrixXd& velocity;  ///< [rad/s] row by row
  const ObservedRows& without;      ///< before `first_judged`: by fits that did not have the row
  const ObservedRows& judged;       ///< from `first_judged` on
  /// [N m] row by row: Coulomb friction at the joint's load.
  const Eigen::MatrixXd& coulomb;
  std::size_t first_judged;  ///< row
};

/// Row by row of the log; rows before the first judged one are not set.
struct LightThresholds {
  Eigen::MatrixXd torque;     ///< [N m] filtered, its size less what is not resolved
  Eigen::MatrixXd threshold;  ///< [N m] infinity where it is not judged
};

/// Thresholds by joint of the filtered external torques, from the rows without contact: apart for a
/// joint that moves and one that is slow or was so within the filters' memory, as friction about
/// reversals is what a model knows least of. Each is the largest error there times a margin: n
/// errors of either sign of Gaussian noise reach std sqrt(2 ln n) [Rice 1944], and
/// `false_alarm_spacing` of them as much more. A slow joint's is at least Coulomb's friction.
/// Joints outside the positions or speeds without contact are not judged. Pure function.
[[nodiscard]] LightThresholds light_thresholds(const LightThresholdInput& input,
                                               const ContactObserverOptions& options);

}  // namespace pcavr
