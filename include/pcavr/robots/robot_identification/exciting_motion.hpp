// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/robot_identification/options.cpp.
struct ExcitingMotionOptions {
  ExcitingMotionOptions();
  double duration;          ///< [s]
  double frequency;         ///< [Hz] of the slowest harmonic
  int harmonics;            ///< of each joint
  double speed_share;       ///< of the joints' velocity limits
  double max_speed;         ///< [rad/s] of joints without a limit
  double max_acceleration;  ///< [rad/s^2]
  double extra_range;       ///< [rad] beyond the recorded range, on either side
  double limit_margin;      ///< [rad] to the joints' position limits
  int candidates;           ///< motions that are compared
};
/// "robot_identification.plan" in a configuration file.
[[nodiscard]] OptionSection section_of(ExcitingMotionOptions& options);

/// A motion from rest to rest, and the stds that a log of it is expected to give.
struct ExcitingMotion {
  std::vector<double> t;                       ///< [s] from 0, every 10 ms
  Eigen::MatrixXd position;                    ///< [rad], a row for each of `t`
  std::vector<double> viscous_std;             ///< [N m s/rad] by joint
  std::vector<double> coulomb_std;             ///< [N m] by joint
  std::vector<BaseParameter> base_parameters;  ///< as the fit's, with the expected std
};

/// The motion that determines bodies and friction best: Fourier series of all joints [Swevers et
/// al. 1997], of which the determinant of the expected information is the largest among
/// `candidates`, by random search. The noise is that of the fit's residuals. Positions stay within
/// what `signals` show, extended by `extra_range`, and within the limits; collisions are not
/// checked. Deterministic; pure function.
[[nodiscard]] ExcitingMotion plan_exciting_motion(const JointSignals& signals,
                                                  const RobotModel& model, const RobotFit& fit,
                                                  const ExcitingMotionOptions& options);

/// A table with the header t, q_NAME for each joint: as joints.csv.
[[nodiscard]] std::string format_motion(const ExcitingMotion& motion, const RobotModel& model);

}  // namespace pcavr
