// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/friction_trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcavr/robots/robot/robot_dynamics.hpp"

#include "robots/robot_identification/arm_simulation.hpp"
#include "robots/robot_identification/friction_torques.hpp"

namespace pcavr {
namespace {

constexpr double kMaxTrialStep = 2e-3;  ///< [s] as the simulators of A's time; see the tests
constexpr double kMaxError = 1.0;       ///< [rad] larger errors, and infinite ones, count as this
constexpr int kCoarsePoints = 9;        ///< a side of the first grid
constexpr int kFinePoints = 5;          ///< a side of the others, which halve the spacing
constexpr int kRefinements = 5;         ///< to 1/256 of the first grid's width
/// Relative changes of the values of all joints: the first and the last that are tried.
constexpr double kFirstChange = 0.2, kLastChange = 0.01;

using detail::RecordedStep;

struct RecordedStretch {
  Eigen::VectorXd q, dq;  ///< at its start
  std::vector<RecordedStep> steps;
  Eigen::MatrixXd position;  ///< [rad] after each `steps_per_row` steps
};

struct Record {
  std::vector<RecordedStretch> stretches;
  int steps_per_row = 1;
  double dt = 0.0;  ///< [s] of a step
};

RecordedStretch record_stretch(const JointSignals& signals, const Eigen::MatrixXd& torque,
                               Eigen::Index first, Eigen::Index rows, int steps_per_row) {
  RecordedStretch stretch{signals.position.row(first).transpose(),
                          signals.velocity.row(first).transpose(),
                          {},
                          signals.position.middleRows(first + 1, rows)};
  for (Eigen::Index row = first; row < first + rows; ++row) {
    for (int k = 0; k < steps_per_row; ++k) {
      const double share = (k + 0.5) / steps_per_row;
      const auto between = [&](const Eigen::MatrixXd& values) -> Eigen::VectorXd {
        return ((1.0 - share) * values.row(row) + share * values.row(row + 1)).transpose();
      };
      stretch.steps.push_back({between(signals.position), between(signals.velocity),
                               between(signals.acceleration), between(torque)});
    }
  }
  return stretch;
}

/// Stretches of the fitted rows that no gap interrupts.
Record record_of(const JointSignals& signals, const Eigen::MatrixXd& torque, const RobotFit& fit,
                 const FrictionTrialOptions& options) {
  Record record;
  record.steps_per_row = std::max(1, static_cast<int>(std::ceil(signals.interval / kMaxTrialStep)));
  record.dt = signals.interval / record.steps_per_row;
  const auto rows = static_cast<Eigen::Index>(std::lround(options.stretch / signals.interval));
  const Eigen::Index last = static_cast<Eigen::Index>(fit.train_rows) - rows - 1;
  for (int k = 0; k < options.stretches && last >= 0 && rows > 0; ++k) {
    const Eigen::Index first = last * k / std::max(1, options.stretches - 1);
    const auto begin = static_cast<std::size_t>(first);
    const double duration = signals.t[begin + static_cast<std::size_t>(rows)] - signals.t[begin];
    if (duration > (static_cast<double>(rows) + 0.5) * signals.interval) continue;
    record.stretches.push_back(record_stretch(signals, torque, first, rows, record.steps_per_row));
  }
  return record;
}

double bounded_square(double error) {
  return std::isfinite(error) ? std::min(error * error, kMaxError * kMaxError)
                              : kMaxError * kMaxError;
}

JointFit with_values(const JointFit& fitted, double viscous, double coulomb) {
  JointFit joint;
  joint.name = fitted.name;
  joint.sign = fitted.sign;
  joint.sign.presliding_displacement = 0.0;  // the trial keeps no state
  joint.friction = {{FrictionTerm::viscous, viscous, 0.0, true},
                    {FrictionTerm::coulomb, coulomb, 0.0, true}};
  return joint;
}

/// One joint moved by its torque, while the others follow the record.
class SingleJointTrial {
 public:
  SingleJointTrial(const Record& record, const RobotModel& robot, Eigen::Index joint)
      : record_(record), simulation_(robot, joint), joint_(joint) {
    for (const RecordedStretch& stretch : record.stretches) {
      for (const RecordedStep& step : stretch.steps) {
        inertia_.push_back(simulation_.inertia(step));
      }
    }
  }

  /// Mean squared position error [rad^2].
  [[nodiscard]] double squared_error(const JointFit& friction) {
    double sum = 0.0;
    std::size_t count = 0;
    std::size_t next = 0;
    FrictionSign sign(friction.sign);
    for (const RecordedStretch& stretch : record_.stretches) {
      double q = stretch.q[joint_];
      double v = stretch.dq[joint_];
      for (std::size_t k = 0; k < stretch.steps.size(); ++k) {
        simulation_.step(stretch.steps[k], inertia_[next++], friction, sign, record_.dt, q, v);
        const std::size_t done = k + 1;
        const auto steps_per_row = static_cast<std::size_t>(record_.steps_per_row);
        if (done % steps_per_row != 0) continue;
        const auto row = static_cast<Eigen::Index>(done / steps_per_row) - 1;
        sum += bounded_square(q - stretch.position(row, joint_));
        ++count;
      }
    }
    return sum / static_cast<double>(count);
  }

 private:
  const Record& record_;
  detail::JointSimulation simulation_;
  Eigen::Index joint_;
  std::vector<double> inertia_;
};

struct GridPoint {
  double viscous = 0.0, coulomb = 0.0;
  double squared_error = std::numeric_limits<double>::max();
};

/// A grid of friction values about the best of the last one, finer by half each time.
class GridSearch {
 public:
  GridSearch(SingleJointTrial& trial, const JointFit& fitted, double max_viscous,
             double max_coulomb)
      : trial_(trial), fitted_(fitted) {
    const double points = kCoarsePoints - 1;
    best_ = {0.5 * max_viscous, 0.5 * max_coulomb};
    search(kCoarsePoints, max_viscous / points, max_coulomb / points);
    for (int k = 1; k <= kRefinements; ++k) {
      const double share = std::ldexp(1.0 / points, -k);
      search(kFinePoints, share * max_viscous, share * max_coulomb);
    }
  }
  [[nodiscard]] const GridPoint& best() const { return best_; }
  [[nodiscard]] int trials() const { return trials_; }

 private:
  void search(int points, double viscous_spacing, double coulomb_spacing) {
    const GridPoint centre = best_;
    const int half = points / 2;
    const int coulomb_half = coulomb_spacing > 0.0 ? half : 0;
    for (int i = -half; i <= half; ++i) {
      for (int k = -coulomb_half; k <= coulomb_half; ++k) {
        GridPoint point{centre.viscous + i * viscous_spacing, centre.coulomb + k * coulomb_spacing};
        if (point.viscous < 0.0 || point.coulomb < 0.0) continue;
        point.squared_error =
            trial_.squared_error(with_values(fitted_, point.viscous, point.coulomb));
        ++trials_;
        if (point.squared_error < best_.squared_error) best_ = point;
      }
    }
  }

  SingleJointTrial& trial_;
  const JointFit& fitted_;
  GridPoint best_;
  int trials_ = 0;
};

/// All joints moved by their torques.
class AllJointsTrial {
 public:
  AllJointsTrial(const Record& record, const RobotModel& robot) : record_(record), robot_(robot) {}

  /// Mean squared position error by joint [rad^2].
  [[nodiscard]] Eigen::VectorXd squared_errors(const std::vector<JointFit>& friction) {
    ++trials_;
    detail::ArmSimulation simulation(friction, robot_);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot_.dof));
    double count = 0.0;
    for (const RecordedStretch& stretch : record_.stretches) {
      detail::MotionState state{stretch.q, stretch.dq};
      std::size_t next = 0;
      for (Eigen::Index row = 0; row < stretch.position.rows(); ++row) {
        for (int k = 0; k < record_.steps_per_row; ++k) {
          const RecordedStep& step = stretch.steps[next++];
          if (state.q.allFinite()) simulation.step(state, step.torque, record_.dt);
        }
        for (Eigen::Index j = 0; j < sum.size(); ++j) {
          sum[j] += bounded_square(state.q[j] - stretch.position(row, j));
        }
        count += 1.0;
      }
    }
    return sum / count;
  }
  [[nodiscard]] int trials() const { return trials_; }

 private:
  const Record& record_;
  const RobotModel& robot_;
  int trials_ = 0;
};

/// Changes one value after the other, by less and less, while the errors of all joints, each over
/// its first, fall.
std::vector<JointFit> refine_together(AllJointsTrial& trial, std::vector<JointFit> joints) {
  const Eigen::VectorXd first = trial.squared_errors(joints).cwiseMax(1e-12);
  double best = static_cast<double>(first.size());
  for (double change = kFirstChange; change >= kLastChange;) {
    bool is_better = false;
    for (JointFit& joint : joints) {
      for (FittedTerm& term : joint.friction) {
        for (const double factor : {1.0 + change, 1.0 / (1.0 + change)}) {
          const double before = term.value;
          term.value *= factor;
          const double score =
              before > 0.0 ? trial.squared_errors(joints).cwiseQuotient(first).sum() : best;
          if (score < best * (1.0 - 1e-4)) {
            best = score;
            is_better = true;
            break;
          }
          term.value = before;
        }
      }
    }
    if (!is_better) change *= 0.5;
  }
  return joints;
}

}  // namespace

std::optional<FrictionTrial> try_friction(const JointSignals& signals, const RobotModel& described,
                                          const RobotFit& fit,
                                          const FrictionTrialOptions& options) {
  const RobotModel robot = fit.robot(described);
  const detail::FrictionTorques torques = detail::friction_torques(signals, robot, fit);
  const Record record = record_of(signals, torques.measured, fit, options);
  if (record.stretches.empty()) return std::nullopt;
  const double duration = static_cast<double>(record.stretches.size()) * options.stretch;
  FrictionTrial found;
  const auto dof = static_cast<Eigen::Index>(robot.dof);
  const auto train = static_cast<Eigen::Index>(fit.train_rows);
  found.alone.position_rms.resize(dof);
  for (Eigen::Index j = 0; j < dof; ++j) {
    const JointFit& fitted = fit.joints[static_cast<std::size_t>(j)];
    // Twice what the torque leaves would be too much at any speed.
    const double most = 2.0 * torques.friction.col(j).head(train).norm() / std::sqrt(double(train));
    const double speed = signals.velocity.col(j).head(train).norm() / std::sqrt(double(train));
    SingleJointTrial trial(record, robot, j);
    const GridSearch search(trial, fitted, most / std::max(speed, 1e-3),
                            options.is_viscous_only ? 0.0 : most);
    found.simulated_time += search.trials() * duration;
    found.alone.joints.push_back(with_values(fitted, search.best().viscous, search.best().coulomb));
    found.alone.position_rms[j] = std::sqrt(search.best().squared_error);
  }
  const double alone_time = found.simulated_time;
  AllJointsTrial all(record, robot);
  found.together.joints = refine_together(all, found.alone.joints);
  found.together.position_rms = all.squared_errors(found.together.joints).cwiseSqrt();
  found.simulated_time += all.trials() * duration;
  found.alone_share = alone_time / found.simulated_time;
  for (TrialStage* stage : {&found.alone, &found.together}) {
    for (std::size_t j = 0; j < stage->joints.size(); ++j) {
      detail::set_torque_errors(signals, torques, fit.train_rows, j, stage->joints[j]);
    }
  }
  return found;
}

}  // namespace pcavr
