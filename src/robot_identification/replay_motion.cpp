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
    0.5e-3;  ///< [s] the error of the first-order steps is some millidegrees
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
  detail::ArmSimulation simulation(fit.joints, fit.robot(model));
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
