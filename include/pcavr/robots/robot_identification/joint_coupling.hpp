// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

/// A motor whose transmission turns with two joints, as in wrists whose last motor is behind the
/// joint before it: its speed is w = dq_driven + ratio dq_carrier. Its inertia and friction f(w,
/// dw/dt) act on the driven joint, and `ratio` times on the carrier [Gautier, Janot & Vandanjon
/// 2013: of a TX40, ratio 1].
struct JointCoupling {
  std::size_t carrier = 0, driven = 0;  ///< joints, in the model's order
  double ratio = 0.0;
  double smoothing_speed = 0.0;  ///< [rad/s] of the sign of w
  FittedTerm inertia = {}, viscous = {}, coulomb = {};
  double gain = 1.0;  ///< factor by which both joints' errors fall, together, in rows left out
};

/// The couplings that the first `train_share` of a log shows: those of which inertia and friction
/// are positive, and that predict the rows which are left out of their fits better in each of five
/// folds, by a factor that the arms without one do not reach. At most three. Deterministic; pure
/// function.
[[nodiscard]] std::vector<JointCoupling> find_couplings(const JointSignals& signals,
                                                        const RobotModel& model,
                                                        double train_share);

/// The torques [N m] that couplings add at the joints, row by row of the signals. Inertia and
/// viscous friction that depend on a joint's own motion alone are not in it: they are part of that
/// joint's motor inertia and friction.
[[nodiscard]] Eigen::MatrixXd coupling_torque(const std::vector<JointCoupling>& couplings,
                                              const JointSignals& signals);

/// Takes the couplings' torques out of signals and log: what is left is that of an arm without
/// them.
void remove_couplings(const std::vector<JointCoupling>& couplings, JointSignals& signals,
                      JointLog& log);

}  // namespace pcavr
