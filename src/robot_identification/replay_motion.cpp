// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robot_identification/replay_motion.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"
#include "pcavr/robot/robot_dynamics.hpp"

namespace pcavr {
namespace {

constexpr double kMaxStep = 1e-3;  ///< [s] friction's sign changes within some milliseconds

struct MotionState {
  Eigen::VectorXd q, dq;
};

class ArmSimulation {
 public:
  ArmSimulation(const RobotFit& fit, const RobotModel& model)
      : fit_(fit), dynamics_(model), acceleration_(Eigen::VectorXd::Zero(
                                         static_cast<Eigen::Index>(model.dof))) {
    has_load_ = std::any_of(fit.joints.begin(), fit.joints.end(), [](const JointFit& joint) {
      return joint.value_of(FrictionTerm::load) != 0.0;
    });
  }

  MotionState step(const MotionState& at, const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                   double dt) {
    const Eigen::VectorXd middle = 0.5 * (from + to);
    const Eigen::VectorXd a1 = acceleration(at, from);
    const MotionState s2{at.q + 0.5 * dt * at.dq, at.dq + 0.5 * dt * a1};
    const Eigen::VectorXd a2 = acceleration(s2, middle);
    const MotionState s3{at.q + 0.5 * dt * s2.dq, at.dq + 0.5 * dt * a2};
    const Eigen::VectorXd a3 = acceleration(s3, middle);
    const MotionState s4{at.q + dt * s3.dq, at.dq + dt * a3};
    const Eigen::VectorXd a4 = acceleration(s4, to);
    return {at.q + dt / 6.0 * (at.dq + 2.0 * s2.dq + 2.0 * s3.dq + s4.dq),
            at.dq + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)};
  }

 private:
  Eigen::VectorXd acceleration(const MotionState& at, const Eigen::VectorXd& torque) {
    Eigen::VectorXd net = torque, load = Eigen::VectorXd::Zero(torque.size());
    // Load-dependent friction takes the rigid-body torque of the last known acceleration.
    if (has_load_) dynamics_.inverse_dynamics(at.q, at.dq, acceleration_, load);
    for (Eigen::Index j = 0; j < torque.size(); ++j) {
      net[j] -= friction_torque(fit_.joints[static_cast<std::size_t>(j)], at.q[j], at.dq[j],
                                load[j]);
    }
    dynamics_.forward_dynamics(at.q, at.dq, net, acceleration_);
    return acceleration_;
  }

  const RobotFit& fit_;
  RobotDynamics dynamics_;
  Eigen::VectorXd acceleration_;
  bool has_load_ = false;
};

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

}  // namespace

MotionReplay replay_motion(const JointSignals& signals, const RobotFit& fit,
                           const RobotModel& model, std::size_t first, double duration) {
  PCAVR_REQUIRE(first < signals.t.size() && duration > 0.0, first, duration);
  const Eigen::Index rows = row_count(signals, first, duration);
  const auto start = static_cast<Eigen::Index>(first);
  MotionReplay replay;
  replay.recorded = signals.position.middleRows(start, rows);
  replay.simulated = replay.recorded;
  const Eigen::MatrixXd torque = signals.torque.middleRows(start, rows) +
                                 fit.torque_lag * signals.torque_rate.middleRows(start, rows);
  ArmSimulation simulation(fit, fit.robot(model));
  MotionState state{signals.position.row(start).transpose(),
                    signals.velocity.row(start).transpose()};
  const int steps = static_cast<int>(std::ceil(signals.interval / kMaxStep));
  const double dt = signals.interval / steps;
  for (Eigen::Index row = 0; row < rows; ++row) {
    replay.t.push_back(signals.t[first + static_cast<std::size_t>(row)]);
    replay.simulated.row(row) = state.q.transpose();
    if (row + 1 == rows || !state.q.allFinite()) continue;
    const Eigen::VectorXd from = torque.row(row).transpose();
    const Eigen::VectorXd change = (torque.row(row + 1) - torque.row(row)).transpose();
    for (int k = 0; k < steps; ++k) {
      state = simulation.step(state, from + change * (double(k) / steps),
                              from + change * (double(k + 1) / steps), dt);
    }
  }
  const Eigen::MatrixXd error = replay.simulated - replay.recorded;
  replay.is_finite = error.allFinite();
  replay.rms = (error.colwise().squaredNorm() / double(rows)).cwiseSqrt().transpose();
  const auto second = static_cast<Eigen::Index>(std::lround(1.0 / signals.interval));
  replay.after_1s = error.row(std::min(rows - 1, second)).cwiseAbs().transpose();
  return replay;
}

}  // namespace pcavr
