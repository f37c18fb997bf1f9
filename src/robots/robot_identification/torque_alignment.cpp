// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/torque_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"

#include "robots/robot_identification/fit_rows.hpp"

namespace pcavr::detail {
namespace {

constexpr double kKnownMassScale = 0.35;  ///< torque below this share of the description's: current
/// Torque above this multiple of the description's: another unit. Descriptions with 1 kg for every
/// body of a heavy arm are some 5 times too light; the next unit in use is 8.85.
constexpr double kMaxMassScale = 7.0;
/// One joint's scale over the others' beyond which its unit is another: a tool that is not
/// described may weigh ten times as much as a wrist, and mN m are 1000 times as many.
constexpr double kOneJointScale = 300.0;
/// Correlation of a torque and the description's above which its scale is that of the weight:
/// another joint's torque, in a swapped column, follows it less.
constexpr double kOneJointAligned = 0.95;
/// Described torque over the largest joint's, rms, of a joint that carries weight.
constexpr double kCarriesWeight = 0.1;
constexpr double kAligned = 0.8;  ///< correlation of torque and the description's

/// The torque of the description's bodies, or of equal masses where it has none.
Eigen::MatrixXd described_torque(const JointSignals& signals, const RobotModel& model) {
  constexpr double kMass = 3.0;  // [kg] of a body without one
  Eigen::VectorXd parameters = inertial_parameters(model);
  for (Eigen::Index k = 0; k < parameters.size(); k += 10) {
    if (parameters[k] <= 0.0) parameters[k] = kMass;
  }
  const std::vector<JointRows> joints = rigid_rows(signals, model);
  Eigen::MatrixXd torque(signals.torque.rows(), signals.torque.cols());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    torque.col(static_cast<Eigen::Index>(j)) = joints[j].rigid * parameters;
  }
  return torque;
}

struct Alignment {
  Eigen::VectorXd correlation;  ///< by joint
  Eigen::VectorXd scale;        ///< recorded over described
  Eigen::VectorXd power;        ///< of the described torque
};

Alignment align(const Eigen::MatrixXd& recorded, const Eigen::MatrixXd& described) {
  const Eigen::RowVectorXd power = described.colwise().squaredNorm();
  const Eigen::RowVectorXd product = described.cwiseProduct(recorded).colwise().sum();
  const Eigen::RowVectorXd norm = recorded.colwise().norm();
  const Eigen::RowVectorXd tiny = Eigen::RowVectorXd::Constant(power.size(), 1e-300);
  return {product.cwiseQuotient(norm.cwiseProduct(power.cwiseSqrt()) + tiny).transpose(),
          product.cwiseQuotient(power + tiny).transpose(), power.transpose()};
}

/// Corrects the sign of all torques where they oppose the description's.
void check_sign(const Alignment& alignment, JointSignals& signals, LogFindings& findings) {
  const double vote = alignment.correlation.cwiseProduct(alignment.power).sum();
  if (vote >= -0.5 * alignment.power.sum()) return;
  signals.torque *= -1.0;
  signals.torque_rate *= -1.0;
  signals.is_sign_changed = true;
  findings.warnings.push_back(
      {.message = fmt::format("torques oppose those that hold the robot (correlation {:.2f}): they "
                              "are the load on the joints; their sign was changed",
                              vote / alignment.power.sum()),
       .place = "tau"});
}

struct TorqueUnit {
  double per_newton_metre;
  const char* name;
};
constexpr auto kTorqueUnits =
    std::to_array<TorqueUnit>({{1e3, "mN m"}, {1e2, "N cm"}, {10.2, "kgf cm"}, {8.85, "lbf in"}});

/// The unit nearest to a scale of the described masses', which are known to a factor of 1.5.
std::string torque_unit(double scale) {
  if (scale < 1.0) return "currents, or another unit";
  std::string unit = "another unit";
  double nearest = std::log(1.5);
  for (const TorqueUnit& candidate : kTorqueUnits) {
    const double distance = std::abs(std::log(scale / candidate.per_newton_metre));
    if (distance >= nearest) continue;
    nearest = distance;
    unit = fmt::format("{}, or another unit", candidate.name);
  }
  return unit;
}

Error scale_error(const RobotModel& model, Eigen::Index joint, double scale) {
  return {.message = fmt::format("torques are {:.2g} times those of the described masses: {}",
                                 scale, torque_unit(scale)),
          .place = "joint " + model.joints[static_cast<std::size_t>(joint)].name,
          .hint = scale < 1.0 ? "name the columns current_NAME and give --gains, or write N m"
                              : "write N m, or correct the masses of the description"};
}

/// The joint that carries weight, follows the description and has the largest scale.
Eigen::Index heaviest_scale(const Alignment& alignment) {
  const double carries = kCarriesWeight * kCarriesWeight * alignment.power.maxCoeff();
  Eigen::Index highest = -1;
  for (Eigen::Index j = 0; j < alignment.scale.size(); ++j) {
    if (alignment.power[j] < carries) continue;
    if (std::abs(alignment.correlation[j]) < kOneJointAligned) continue;
    if (highest < 0 || std::abs(alignment.scale[j]) > std::abs(alignment.scale[highest])) {
      highest = j;
    }
  }
  return highest;
}

/// Torques in another unit, of all joints or of one. A torque that is too large may be friction's
/// of a joint that carries no weight.
void check_scale(const Alignment& alignment, const RobotModel& model, LogFindings& findings) {
  std::vector<double> scales;
  Eigen::Index lowest = 0;
  for (Eigen::Index j = 0; j < alignment.scale.size(); ++j) {
    if (std::abs(alignment.correlation[j]) < kAligned) continue;
    const double scale = std::abs(alignment.scale[j]);
    if (scales.empty() || scale < *std::min_element(scales.begin(), scales.end())) lowest = j;
    scales.push_back(scale);
  }
  if (scales.empty()) {
    findings.warnings.push_back(
        {.message = "the unit of the torques does not show: no joint's follow the weight of the "
                    "described bodies in this motion; check that they are N m"});
    return;
  }
  const double scale = median(scales);
  if (scale < kKnownMassScale) {
    findings.errors.push_back(scale_error(model, lowest, scale));
    return;
  }
  const Eigen::Index highest = heaviest_scale(alignment);
  if (highest < 0) return;
  const double of_highest = std::abs(alignment.scale[highest]);
  if (scale > kMaxMassScale && of_highest > kMaxMassScale) {
    findings.errors.push_back(scale_error(model, highest, scale));
  } else if (of_highest > kOneJointScale * scale) {
    findings.errors.push_back(scale_error(model, highest, of_highest));
  }
}

}  // namespace

void check_described_torques(const RobotModel& model, JointSignals& signals, JointSignals& few,
                             LogFindings& findings) {
  const Alignment alignment = align(few.torque, described_torque(few, model));
  check_sign(alignment, signals, findings);
  if (signals.is_sign_changed) few.torque *= -1.0;
  if (model.has_inertia()) check_scale(alignment, model, findings);
}

}  // namespace pcavr::detail
