// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/replay_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "robots/robot_identification/arm_simulation.hpp"

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

/// The rows that are replayed.
class ReplayedStretch {
 public:
  ReplayedStretch(const JointLog& log, const JointSignals& signals, const RobotFit& fit,
                  const RobotModel& robot, Eigen::Index first, Eigen::Index rows)
      : log_(log),
        signals_(signals),
        fit_(fit),
        robot_(robot),
        first_(first),
        rows_(rows),
        steps_(static_cast<int>(std::ceil(signals.interval / kMaxStep))),
        dt_(signals.interval / steps_) {}

  [[nodiscard]] SimulatedMotion simulate_together() const {
    Eigen::VectorXd signs(signals_.position.cols());
    for (Eigen::Index j = 0; j < signs.size(); ++j) signs[j] = starting_sign(j);
    detail::ArmSimulation simulation(fit_.joints, robot_, signs);
    detail::MotionState state{signals_.position.row(first_).transpose(),
                              signals_.velocity.row(first_).transpose()};
    Eigen::MatrixXd position(rows_, signs.size());
    for (Eigen::Index row = 0; row < rows_; ++row) {
      position.row(row) = state.q.transpose();
      if (row + 1 == rows_ || !state.q.allFinite()) continue;
      for (int k = 0; k < steps_; ++k) simulation.step(state, torque_of(row, k), dt_);
    }
    return judged(std::move(position));
  }

  [[nodiscard]] SimulatedMotion simulate_alone() const {
    Eigen::MatrixXd position(rows_, signals_.position.cols());
    for (Eigen::Index j = 0; j < position.cols(); ++j) {
      const auto index = static_cast<std::size_t>(j);
      detail::JointSimulation simulation(robot_, j);
      FrictionSign sign(fit_.joints[index].sign, starting_sign(j));
      double q = signals_.position(first_, j);
      double v = signals_.velocity(first_, j);
      for (Eigen::Index row = 0; row < rows_; ++row) {
        position(row, j) = q;
        if (row + 1 == rows_ || !std::isfinite(q)) continue;
        for (int k = 0; k < steps_; ++k) {
          const detail::RecordedStep step = step_of(row, k);
          simulation.step(step, simulation.inertia(step), fit_.joints[index], sign, dt_, q, v);
        }
      }
    }
    return judged(std::move(position));
  }

 private:
  [[nodiscard]] double starting_sign(Eigen::Index joint) const {
    const auto index = static_cast<std::size_t>(joint);
    return friction_sign(fit_.joints[index].sign, signals_, index)[first_];
  }

  [[nodiscard]] Eigen::VectorXd torque_of(Eigen::Index row, int step) const {
    const double t = signals_.t[static_cast<std::size_t>(first_ + row)] + (step + 0.5) * dt_;
    return (signals_.is_sign_changed ? -1.0 : 1.0) * torque_at(log_, t + fit_.torque_lag);
  }

  [[nodiscard]] detail::RecordedStep step_of(Eigen::Index row, int step) const {
    const double share = (step + 0.5) / steps_;
    const auto between = [&](const Eigen::MatrixXd& values) -> Eigen::VectorXd {
      return ((1.0 - share) * values.row(first_ + row) + share * values.row(first_ + row + 1))
          .transpose();
    };
    return {between(signals_.position), between(signals_.velocity), between(signals_.acceleration),
            torque_of(row, step)};
  }

  [[nodiscard]] SimulatedMotion judged(Eigen::MatrixXd position) const {
    const Eigen::MatrixXd error = position - signals_.position.middleRows(first_, rows_);
    SimulatedMotion motion;
    motion.position = std::move(position);
    motion.is_finite = error.allFinite();
    motion.rms = (error.colwise().squaredNorm() / double(rows_)).cwiseSqrt().transpose();
    motion.kept.resize(error.cols());
    for (Eigen::Index j = 0; j < error.cols(); ++j) {
      Eigen::Index row = 0;
      while (row + 1 < rows_ && std::abs(error(row + 1, j)) < kKept) ++row;
      motion.kept[j] = signals_.t[static_cast<std::size_t>(first_ + row)] -
                       signals_.t[static_cast<std::size_t>(first_)];
    }
    return motion;
  }

  const JointLog& log_;
  const JointSignals& signals_;
  const RobotFit& fit_;
  const RobotModel& robot_;
  Eigen::Index first_, rows_;
  int steps_;  ///< a row
  double dt_;  ///< [s]
};

}  // namespace

MotionReplay replay_motion(const JointLog& log, const JointSignals& signals, const RobotFit& fit,
                           const RobotModel& model, std::size_t first, double duration) {
  PCAVR_REQUIRE(first < signals.t.size() && duration > 0.0, first, duration);
  const Eigen::Index rows = row_count(signals, first, duration);
  const auto start = static_cast<Eigen::Index>(first);
  const RobotModel robot = fit.robot(model);
  const ReplayedStretch stretch(log, signals, fit, robot, start, rows);
  MotionReplay replay;
  const auto begin = signals.t.begin() + start;
  replay.t.assign(begin, begin + rows);
  replay.recorded = signals.position.middleRows(start, rows);
  replay.simulated = stretch.simulate_together();
  replay.alone = stretch.simulate_alone();
  replay.tolerable_torque = tolerable_torque(signals, fit, robot, start, rows);
  const auto second = static_cast<Eigen::Index>(std::lround(1.0 / signals.interval));
  const Eigen::Index at = std::min(rows - 1, second);
  replay.after_1s =
      (replay.simulated.position.row(at) - replay.recorded.row(at)).cwiseAbs().transpose();
  return replay;
}

}  // namespace pcavr
