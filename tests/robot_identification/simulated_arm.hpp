// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/urdf.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"

#include "support/source_folder.hpp"

namespace pcavr {

inline RobotModel pa10() {
  const auto model = read_urdf(source_folder() / "calib/robots/pa10/pa10.urdf");
  EXPECT_TRUE(model) << (model ? "" : model.error().to_string());
  return *model;
}

struct PlantFriction {
  double viscous, coulomb, offset;
};

/// Friction of the simulated arm's joint, falling from base to wrist.
inline PlantFriction plant_friction(Eigen::Index joint) {
  const double share = 1.0 - 0.12 * static_cast<double>(joint);
  return {8.0 * share, 5.0 * share, 0.3 * share};
}

struct SimulatedLogOptions {
  double duration = 30.0;        ///< [s]
  double rate = 200.0;           ///< [Hz]
  double torque_noise = 0.3;     ///< [N m] std, of base joints; less at the wrist
  double position_noise = 2e-5;  ///< [rad] std
  double torque_delay = 0.0;     ///< [s]
  double amplitude_share = 1.0;  ///< of the usual motion
  std::uint64_t seed = 3;
};

/// The log of a motion, with the torques of bodies and friction by inverse dynamics. The plant is
/// not the fitted model: its friction changes sign by a Stribeck curve and without smoothing.
/// `state_at(t, q, dq, ddq)` sets the state.
template <typename StateAt>
JointLog log_of_motion(const RobotModel& model, const SimulatedLogOptions& options, Random& random,
                       const StateAt& state_at) {
  const auto dof = static_cast<Eigen::Index>(model.dof);
  const auto rows = static_cast<Eigen::Index>(options.duration * options.rate);
  JointLog log;
  for (Eigen::Index j = 0; j < dof; ++j) {
    log.joints.push_back(model.joints[static_cast<std::size_t>(j)].name);
  }
  log.position.resize(rows, dof);
  log.torque.resize(rows, dof);
  RobotDynamics dynamics(model);
  Eigen::VectorXd q(dof), dq(dof), ddq(dof), tau(dof);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) / options.rate;
    log.stamps.push_back(Stamp::from_seconds(100.0 + t));
    log.t.push_back(t);
    log.lines.push_back(static_cast<int>(i) + 2);
    state_at(t - options.torque_delay, q, dq, ddq);
    dynamics.inverse_dynamics(q, dq, ddq, tau);
    for (Eigen::Index j = 0; j < dof; ++j) {
      const PlantFriction f = plant_friction(j);
      const double sign = std::tanh(dq[j] / 1e-3);
      tau[j] += f.offset + f.viscous * dq[j] +
                f.coulomb * sign * (1.0 + 0.1 * std::exp(-std::pow(dq[j] / 0.02, 2)));
      const double share = 1.0 - 0.12 * static_cast<double>(j);
      log.torque(i, j) = tau[j] + options.torque_noise * share * random.normal();
    }
    state_at(t, q, dq, ddq);
    for (Eigen::Index j = 0; j < dof; ++j) {
      log.position(i, j) = q[j] + options.position_noise * random.normal();
    }
  }
  return log;
}

/// A Fourier motion of all joints.
inline JointLog simulated_log(const RobotModel& model, const SimulatedLogOptions& options = {}) {
  const auto dof = static_cast<Eigen::Index>(model.dof);
  Random random(options.seed);
  constexpr int kHarmonics = 5;
  Eigen::MatrixXd amplitude(dof, kHarmonics), phase(dof, kHarmonics);
  for (Eigen::Index j = 0; j < dof; ++j) {
    for (int k = 0; k < kHarmonics; ++k) {
      amplitude(j, k) = options.amplitude_share * random.uniform(0.1, 0.35);
      phase(j, k) = random.uniform(0.0, 6.28);
    }
  }
  return log_of_motion(
      model, options, random,
      [&](double t, Eigen::VectorXd& q, Eigen::VectorXd& dq, Eigen::VectorXd& ddq) {
        for (Eigen::Index j = 0; j < dof; ++j) {
          q[j] = dq[j] = ddq[j] = 0.0;
          for (int k = 0; k < kHarmonics; ++k) {
            const double w = 2.0 * 3.14159265358979 * 0.1 * (k + 1);
            const double a = amplitude(j, k), p = w * t + phase(j, k);
            q[j] += a * std::sin(p);
            dq[j] += a * w * std::cos(p);
            ddq[j] -= a * w * w * std::sin(p);
          }
        }
      });
}

/// The motion through the rows of `position`, one every `interval` [s].
inline JointLog simulated_log_along(const RobotModel& model, const Eigen::MatrixXd& position,
                                    double interval, SimulatedLogOptions options) {
  options.duration = interval * static_cast<double>(position.rows() - 1);
  Random random(options.seed);
  const Eigen::Index last = position.rows() - 2;
  return log_of_motion(
      model, options, random,
      [&](double t, Eigen::VectorXd& q, Eigen::VectorXd& dq, Eigen::VectorXd& ddq) {
        // Quadratic through the three nearest rows.
        const auto row = std::clamp<Eigen::Index>(std::lround(t / interval), 1, last);
        const double s = t / interval - static_cast<double>(row);
        const Eigen::VectorXd before = position.row(row - 1), at = position.row(row),
                              after = position.row(row + 1);
        const Eigen::VectorXd slope = 0.5 * (after - before), curve = after - 2.0 * at + before;
        q = at + s * slope + 0.5 * s * s * curve;
        dq = (slope + s * curve) / interval;
        ddq = curve / (interval * interval);
      });
}

/// A motor behind joint `carrier` that turns with joint `driven`, too: its speed is dq_driven +
/// ratio dq_carrier.
struct CoupledMotor {
  Eigen::Index carrier = 4, driven = 5;
  double ratio = 1.0;
  double inertia = 0.4, viscous = 3.0, coulomb = 6.0;  ///< [kg m^2, N m s/rad, N m]
};

/// Adds the motor's torque at both joints, of the motion's derivatives without noise.
inline void add_coupled_motor(const CoupledMotor& motor, JointLog& log) {
  const double interval = log.t[1] - log.t[0];
  const auto smooth = [&](Eigen::Index joint) {
    return filter_zero_phase(log.position.col(joint), 1.0 / interval, 8.0);
  };
  const Eigen::VectorXd angle = smooth(motor.driven) + motor.ratio * smooth(motor.carrier);
  const Eigen::VectorXd speed = differentiate(angle, interval);
  const Eigen::VectorXd torque = motor.inertia * differentiate(speed, interval) +
                                 motor.viscous * speed +
                                 motor.coulomb * (speed.array() / 1e-3).tanh().matrix();
  log.torque.col(motor.driven) += torque;
  log.torque.col(motor.carrier) += motor.ratio * torque;
}

}  // namespace pcavr
