// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/robots/robot_identification/contact_observer.hpp"

#include "robots/robot_identification/light_thresholds.hpp"
#include "robots/robot_identification/observed_rows.hpp"

namespace pcavr {
namespace {

std::size_t row_at(const JointLog& log, double t) {
  return static_cast<std::size_t>(std::lower_bound(log.t.begin(), log.t.end(), t) - log.t.begin());
}

/// Observes each row before the first judged one, by the fit that left it out.
ObservedRows observe_left_out(const JointLog& log, const Eigen::MatrixXd& velocity,
                              const RobotModel& described, const RobotFit& fit, double sign,
                              std::size_t first_judged, const ContactObserverOptions& options) {
  ObservedRows found(log.position.rows(), log.position.cols());
  for (const LeftOutFit& left_out : fit.left_out) {
    const RowRange stretch{row_at(log, left_out.begin),
                           std::min(row_at(log, left_out.end), first_judged)};
    if (stretch.begin >= stretch.end) continue;
    const ContactObserver observer(
        fitted_robot(described, left_out.inertial_parameters, left_out.joints), left_out.joints,
        options);
    const RowRange settled{row_at(log, left_out.begin - settling_time(options)), stretch.end};
    found.take(observe_rows(log, velocity, settled, observer, sign, options), stretch);
  }
  return found;
}

/// The largest external torques [N m] by joint of the rows that the observer's start left.
Eigen::VectorXd largest_of(const ObservedRows& observed, std::size_t end,
                           const ContactObserverOptions& options) {
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(observed.external.cols());
  for (std::size_t row = 0; row < end; ++row) {
    if (!observed.is_settled(row, options)) continue;
    largest = largest.cwiseMax(
        observed.external.row(static_cast<Eigen::Index>(row)).transpose().cwiseAbs());
  }
  return largest;
}

/// Coulomb friction [N m] at the joints' loads, from row `begin` on.
Eigen::MatrixXd coulomb_friction(const JointLog& log, const RobotModel& described,
                                 const RobotFit& fit, std::size_t begin) {
  RobotDynamics dynamics(fit.robot(described));
  Eigen::MatrixXd coulomb = Eigen::MatrixXd::Zero(log.position.rows(), log.position.cols());
  Eigen::VectorXd load(log.position.cols());
  for (auto i = static_cast<Eigen::Index>(begin); i < log.position.rows(); ++i) {
    const Eigen::VectorXd q = log.position.row(i).transpose();
    dynamics.gravity_torque(q, load);
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const JointFit& joint = fit.joints[static_cast<std::size_t>(j)];
      coulomb(i, j) = 0.5 * std::abs(friction_torque(joint, q[j], 0.0, load[j], 1.0) -
                                     friction_torque(joint, q[j], 0.0, load[j], -1.0));
    }
  }
  return coulomb;
}

/// The ratio of each joint's external torque to the threshold that it exceeds most.
Eigen::ArrayXd torque_ratios(const ObservedRows& observed, const ObservedContacts& found,
                             std::size_t row, const ContactObserverOptions& options) {
  const auto i = static_cast<Eigen::Index>(row);
  Eigen::ArrayXd ratio =
      found.light_torque.row(i).cwiseQuotient(found.light_thresholds.row(i)).transpose();
  if (!observed.is_settled(row, options)) return ratio;
  // Unresolved torques count from half a threshold on, and fully where they alone would be a
  // touch.
  const Eigen::ArrayXd unresolved =
      observed.unresolved.row(i).transpose().array() / found.thresholds.array();
  const Eigen::ArrayXd external =
      observed.external.row(i).transpose().array().abs() / found.thresholds.array();
  return ratio.max(external - (2.0 * unresolved - 1.0).max(0.0).min(unresolved));
}

/// Onsets of rows above a threshold; the arm is free again after the same time below all of them.
void find_touches(const JointLog& log, const ObservedRows& observed,
                  const ContactObserverOptions& options, ObservedContacts& found) {
  double above_since = -1.0;
  double below_since = log.t[found.first_judged];
  bool is_above = false;
  bool is_touching = false;
  for (std::size_t row = found.first_judged; row < log.t.size(); ++row) {
    Eigen::Index joint = 0;
    const bool exceeds = torque_ratios(observed, found, row, options).maxCoeff(&joint) > 1.0;
    if (exceeds && !is_above) above_since = log.t[row];
    if (!exceeds && is_above) below_since = log.t[row];
    is_above = exceeds;
    if (exceeds && !is_touching && log.t[row] - above_since >= options.min_duration) {
      is_touching = true;
      found.touches.push_back({log.t[row], static_cast<std::size_t>(joint), std::nullopt});
    }
    if (!exceeds && is_touching && log.t[row] - below_since >= 10.0 * options.min_duration) {
      is_touching = false;
    }
  }
}

/// Adds the forces of the touches, by the torques behind the observer's filter alone.
void add_forces(const JointLog& log, RobotDynamics& kinematics, std::size_t tip,
                ObservedContacts& found) {
  Matrix6Xd jacobian(6, log.position.cols());
  for (ObservedContacts::JointTouch& touch : found.touches) {
    const auto row = static_cast<Eigen::Index>(row_at(log, touch.t));
    kinematics.jacobian(log.position.row(row).transpose(), tip, jacobian);
    touch.force_base = tip_force(jacobian, found.external.row(row).transpose(), found.thresholds);
  }
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Adds the torques and forces that can be detected.
void add_detectable(const JointLog& log, RobotDynamics& kinematics, std::size_t tip,
                    ObservedContacts& found) {
  constexpr std::size_t kSamples = 200;
  const std::size_t step = std::max<std::size_t>(1, (log.t.size() - found.first_judged) / kSamples);
  Matrix6Xd jacobian(6, log.position.cols());
  std::vector<std::vector<double>> torques(static_cast<std::size_t>(log.position.cols()));
  std::vector<double> forces;
  double sum_of_largest = 0.0;
  for (std::size_t row = found.first_judged; row < log.t.size(); row += step) {
    const auto i = static_cast<Eigen::Index>(row);
    const Eigen::VectorXd lower =
        found.thresholds.cwiseMin(found.light_thresholds.row(i).transpose());
    for (std::size_t j = 0; j < torques.size(); ++j) {
      torques[j].push_back(lower[static_cast<Eigen::Index>(j)]);
    }
    kinematics.jacobian(log.position.row(i).transpose(), tip, jacobian);
    double largest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double share =
          jacobian.row(axis).transpose().cwiseAbs().cwiseQuotient(lower).maxCoeff();
      forces.push_back(1.0 / share);
      largest = std::max(largest, forces.back());
    }
    sum_of_largest += largest;
  }
  found.detectable_force = sum_of_largest / (static_cast<double>(forces.size()) / 3.0);
  found.usual_detectable_force = median(forces);
  found.detectable_torque.resize(log.position.cols());
  for (std::size_t j = 0; j < torques.size(); ++j) {
    found.detectable_torque[static_cast<Eigen::Index>(j)] = median(torques[j]);
  }
}

}  // namespace

ObservedContacts observe_contacts(const JointLog& log, const RobotModel& described,
                                  const RobotFit& fit, bool is_sign_changed, double calibration_end,
                                  std::size_t tip, const ContactObserverOptions& options) {
  const double sign = is_sign_changed ? -1.0 : 1.0;
  const Eigen::MatrixXd velocity = joint_velocities(log);
  const ContactObserver observer(fit.robot(described), fit.joints, options);
  ObservedRows observed = observe_rows(log, velocity, {0, log.t.size()}, observer, sign, options);
  ObservedContacts found;
  found.first_judged = std::min(row_at(log, calibration_end), log.t.size() - 1);
  const ObservedRows left_out =
      observe_left_out(log, velocity, described, fit, sign, found.first_judged, options);
  const Eigen::VectorXd largest = largest_of(observed, found.first_judged, options)
                                      .cwiseMax(largest_of(left_out, found.first_judged, options));
  // Thresholds are never 0, which no torque could stay below.
  found.thresholds = (options.margin * largest).cwiseMax(1e-6);
  const Eigen::MatrixXd coulomb = coulomb_friction(log, described, fit, found.first_judged);
  LightThresholds light = light_thresholds({.log = log,
                                            .velocity = velocity,
                                            .without = left_out,
                                            .judged = observed,
                                            .coulomb = coulomb,
                                            .first_judged = found.first_judged},
                                           options);
  found.light_torque = std::move(light.torque);
  found.light_thresholds = std::move(light.threshold);
  find_touches(log, observed, options, found);
  found.external = std::move(observed.external);
  RobotDynamics kinematics(described);
  add_forces(log, kinematics, tip, found);
  add_detectable(log, kinematics, tip, found);
  return found;
}

std::string detectable_force_text(const ObservedContacts& contacts) {
  if (!std::isfinite(contacts.usual_detectable_force)) {
    return "a force moves no joint in most directions, and is not found";
  }
  return fmt::format(
      "a force of {:.3g} N is found, in the median of the axes of base and the rows; {}",
      contacts.usual_detectable_force,
      std::isfinite(contacts.detectable_force)
          ? fmt::format("one of {:.3g} N along the axis that takes most, in the mean of the rows",
                        contacts.detectable_force)
          : "along one axis it moves no joint in some row, and is not found");
}

}  // namespace pcavr
