// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robot_identification/replay_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/core/check.hpp"

#include "robot_identification/arm_simulation.hpp"

namespace pcavr {
namespace {

constexpr double kMaxStep =
    0.5e-3;                         ///< [s] the error of the first-order steps is some millidegrees
constexpr double kResolved = 1e-6;  ///< [N m] no sensor of a joint's torque resolves less
constexpr double kKept = 3.0 * std::numbers::pi / 180.0;  ///< [rad] an error that is accepted

Eigen::VectorXd torque_at(const JointLog& log, double t) {
  const auto after = std::upper_bound(log.t.begin() + 1, log.t.end() - 1, t);
  const auto row = static_cast<std::size_t>(after - log.t.begin());
  const double width = log.t[row] - log.t[row - 1];
  const double share = std::clamp((t - log.t[row - 1]) / width, 0.0, 1.0);
  const auto at = static_cast<Eigen::Index>(row);
  return ((1.0 - share) * log.torque.row(at - 1) + share * log.torque.row(at)).transpose();
}

/// The rows from `first` on that follow each other without a gap, up to `duration`.
Eigen::Index row_count(const JointSignals& signals, std::size_t first, double duration) {
  std::size_t last = first;
  while (last + 1 < signals.t.size() &&
         signals.t[last + 1] - signals.t[last] < 1.5 * signals.interval &&
         signals.t[last + 1] - signals.t[first] <= duration) {
    ++last;
  }
  return static_cast<Eigen::Index>(last - first) + 1;
}

/// Small motions about the recorded one: mass x'' + damping x' + stiffness x = torque error.
struct Linearised {
  Eigen::MatrixXd mass, damping, stiffness;
};

class Linearisation {
 public:
  Linearisation(const RobotFit& fit, const RobotModel& robot)
      : fit_(fit), dynamics_(robot), dof_(static_cast<Eigen::Index>(robot.dof)) {}

  [[nodiscard]] Linearised at(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                              const Eigen::VectorXd& ddq) {
    constexpr double kStep = 1e-5;  // [rad], [rad/s]
    Linearised about{Eigen::MatrixXd(dof_, dof_), Eigen::MatrixXd(dof_, dof_),
                     Eigen::MatrixXd(dof_, dof_)};
    dynamics_.mass_matrix(q, about.mass);
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(dof_, j);
      about.stiffness.col(j) =
          (torque(q + step, dq, ddq) - torque(q - step, dq, ddq)) / (2.0 * kStep);
      about.damping.col(j) =
          (torque(q, dq + step, ddq) - torque(q, dq - step, ddq)) / (2.0 * kStep);
    }
    return about;
  }

 private:
  [[nodiscard]] Eigen::VectorXd torque(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                                       const Eigen::VectorXd& ddq) {
    Eigen::VectorXd all(dof_), bias(dof_);
    dynamics_.inverse_dynamics(q, dq, ddq, all);
    dynamics_.inverse_dynamics(q, dq, Eigen::VectorXd::Zero(dof_), bias);
    for (Eigen::Index j = 0; j < dof_; ++j) {
      all[j] += friction_torque(fit_.joints[static_cast<std::size_t>(j)], q[j], dq[j], bias[j]);
    }
    return all;
  }

  const RobotFit& fit_;
  RobotDynamics dynamics_;
  Eigen::Index dof_;
};

/// See MotionReplay. Implicit steps from row to row: friction's damping is stiff.
Eigen::VectorXd tolerable_torque(const JointSignals& signals, const RobotFit& fit,
                                 const RobotModel& robot, Eigen::Index first, Eigen::Index rows) {
  const Eigen::Index dof = signals.position.cols();
  const double dt = signals.interval;
  Linearisation linearisation(fit, robot);
  // Column by column, the motion due to a unit torque error of one joint.
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(dof, dof), dx = x, squares = x;
  for (Eigen::Index row = first; row < first + rows; ++row) {
    const Linearised about = linearisation.at(signals.position.row(row).transpose(),
                                              signals.velocity.row(row).transpose(),
                                              signals.acceleration.row(row).transpose());
    const Eigen::MatrixXd implicit = about.mass + dt * (about.damping + dt * about.stiffness);
    const Eigen::MatrixXd error = Eigen::MatrixXd::Identity(dof, dof) - about.stiffness * x;
    dx = implicit.partialPivLu().solve(about.mass * dx + dt * error);
    x += dt * dx;
    squares += x.cwiseAbs2();
  }
  const Eigen::RowVectorXd rms = (squares / double(rows)).cwiseSqrt().colwise().maxCoeff();
  return (kKept * rms.cwiseInverse().transpose()).cwiseMax(kResolved);
}

}  // namespace

MotionReplay replay_motion(const JointLog& log, const JointSignals& signals, const RobotFit& fit,
                           const RobotModel& model, std::size_t first, double duration) {
  PCAVR_REQUIRE(first < signals.t.size() && duration > 0.0, first, duration);
  const Eigen::Index rows = row_count(signals, first, duration);
  const auto start = static_cast<Eigen::Index>(first);
  MotionReplay replay;
  replay.recorded = signals.position.middleRows(start, rows);
  replay.simulated = replay.recorded;
  const double sign = signals.is_sign_changed ? -1.0 : 1.0;
  const RobotModel robot = fit.robot(model);
  replay.tolerable_torque = tolerable_torque(signals, fit, robot, start, rows);
  Eigen::VectorXd signs(signals.position.cols());
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    signs[static_cast<Eigen::Index>(j)] = friction_sign(fit.joints[j].sign, signals, j)[start];
  }
  detail::ArmSimulation simulation(fit.joints, robot, signs);
  detail::MotionState state{signals.position.row(start).transpose(),
                            signals.velocity.row(start).transpose()};
  const int steps = static_cast<int>(std::ceil(signals.interval / kMaxStep));
  const double dt = signals.interval / steps;
  for (Eigen::Index row = 0; row < rows; ++row) {
    replay.t.push_back(signals.t[first + static_cast<std::size_t>(row)]);
    replay.simulated.row(row) = state.q.transpose();
    if (row + 1 == rows || !state.q.allFinite()) continue;
    for (int k = 0; k < steps; ++k) {
      const double t = replay.t.back() + (double(k) + 0.5) * dt + fit.torque_lag;
      simulation.step(state, sign * torque_at(log, t), dt);
    }
  }
  const Eigen::MatrixXd error = replay.simulated - replay.recorded;
  replay.is_finite = error.allFinite();
  replay.rms = (error.colwise().squaredNorm() / double(rows)).cwiseSqrt().transpose();
  const auto second = static_cast<Eigen::Index>(std::lround(1.0 / signals.interval));
  replay.after_1s = error.row(std::min(rows - 1, second)).cwiseAbs().transpose();
  replay.kept.resize(error.cols());
  for (Eigen::Index j = 0; j < error.cols(); ++j) {
    Eigen::Index row = 0;
    while (row + 1 < rows && std::abs(error(row + 1, j)) < kKept) ++row;
    replay.kept[j] = replay.t[static_cast<std::size_t>(row)] - replay.t.front();
  }
  return replay;
}

}  // namespace pcavr
