// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

/// The factors that turn a drive's current into its joint's torque.
struct DriveGains {
  Eigen::VectorXd gain;  ///< [N m/A] by joint; negative where the current has the other sign
  Eigen::VectorXd std;   ///< [N m/A]
};

/// The gains K from the currents of two runs, of which one carries a load of known mass [kg]:
/// i = tau / K + friction, where tau is linear in the bodies' inertial parameters and the load's.
/// Relative gains follow from the bodies, which all joints share, their scale from the mass; the
/// load's other nine parameters are fitted along [Gautier & Briot 2014]. Unlike there the currents
/// are what is predicted, so that their noise does not make gains too small. `unloaded`, `loaded`:
/// signals with currents [A] in place of torques; `model`: with their joints. Gauss-Newton from the
/// description's masses. A joint that no run moves under load has a large std. Deterministic; pure
/// function.
[[nodiscard]] DriveGains identify_drive_gains(const JointSignals& unloaded,
                                              const JointSignals& loaded, const RobotModel& model,
                                              double load_mass, const RobotFitOptions& options);

}  // namespace pcavr
