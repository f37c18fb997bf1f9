// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/robot/torque_scale.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "pcavr/robots/robot/robot_dynamics.hpp"

namespace pcavr {
namespace {

/// Weight that is less than this share of the torques does not show their scale.
constexpr double kMinWeightShare = 0.1;
/// Differences of a description that are usual, and from which on it contradicts the torques.
constexpr double kNotedShare = 0.05;
constexpr double kContradiction = 1.5;
constexpr Eigen::Index kSampledRows = 100;

/// Sums over rows of the log, by joint.
struct InertiaSums {
  Eigen::VectorXd described, fitted;  ///< diagonal of the mass matrix [kg m^2]
  double weight = 0.0, torque = 0.0;  ///< squares [N^2 m^2]
};

InertiaSums sum_inertia(const RobotIdentification& found) {
  RobotDynamics described(found.model), fitted(found.fit.robot(found.model));
  const Eigen::Index joints = found.signals.position.cols(), rows = found.signals.position.rows();
  InertiaSums sums{Eigen::VectorXd::Zero(joints), Eigen::VectorXd::Zero(joints)};
  Eigen::MatrixXd mass(joints, joints);
  Eigen::VectorXd weight(joints);
  for (Eigen::Index i = 0; i < rows; i += std::max<Eigen::Index>(1, rows / kSampledRows)) {
    const Eigen::VectorXd q = found.signals.position.row(i).transpose();
    described.mass_matrix(q, mass);
    sums.described += mass.diagonal();
    fitted.mass_matrix(q, mass);
    sums.fitted += mass.diagonal();
    described.gravity_torque(q, weight);
    sums.weight += weight.squaredNorm();
    sums.torque += found.signals.torque.row(i).squaredNorm();
  }
  return sums;
}

/// The factor of the joint that differs most; nothing where weight shows the torques' scale.
std::optional<double> inertia_factor(const RobotIdentification& found) {
  if (!found.model.has_inertia() || !found.fit.is_physical) return std::nullopt;
  const InertiaSums sums = sum_inertia(found);
  if (sums.weight > kMinWeightShare * kMinWeightShare * sums.torque) return std::nullopt;
  double factor = 1.0;
  for (Eigen::Index j = 0; j < sums.described.size(); ++j) {
    const double of_joint = sums.fitted[j] / sums.described[j];
    if (!std::isfinite(of_joint) || of_joint <= 0.0) return std::nullopt;
    if (std::abs(std::log(of_joint)) > std::abs(std::log(factor))) factor = of_joint;
  }
  return factor;
}

}  // namespace

void doubt_torque_scale(RobotIdentification& found) {
  const std::optional<double> factor = inertia_factor(found);
  if (!factor) return;
  const double share = std::abs(1.0 - 1.0 / *factor);
  for (JointFit& joint : found.fit.joints) {
    for (std::vector<FittedTerm>* terms : {&joint.friction, &joint.equivalent}) {
      for (FittedTerm& term : *terms) term.std = std::hypot(term.std, share * term.value);
    }
  }
  if (share < kNotedShare) return;
  const bool is_contradiction = std::max(*factor, 1.0 / *factor) >= kContradiction;
  found.notes.push_back(fmt::format(
      "{}the torques show {:.3g} times the inertia of the description, and no weight that would "
      "show their scale: {}; friction's stds contain that factor",
      is_contradiction ? "contradiction: " : "", *factor,
      "check their unit, the gains, the stamps and the description"));
}

}  // namespace pcavr
