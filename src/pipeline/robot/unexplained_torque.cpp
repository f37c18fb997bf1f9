// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/robot/unexplained_torque.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace pcavr {
namespace {

/// Relative error of torques up to which noise and a usual gear's ripple explain it: real arms have
/// 5 to 20 %. At twice as much, all of it counts.
constexpr double kUsualError = 0.2;

/// Size of a term's factor over the motion, in the unit that makes its value a torque [N m]: 1 for
/// signs and ripple.
double size_of(FrictionTerm term, const JointFit& fit, const JointSignals& signals,
               Eigen::Index joint) {
  const auto rms = [](const auto& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
  };
  const auto speed = signals.velocity.col(joint);
  switch (term) {
    case FrictionTerm::viscous:
    case FrictionTerm::asymmetric:
      return rms(speed);
    case FrictionTerm::quadratic:
      return rms(speed.cwiseAbs2());
    case FrictionTerm::stribeck:
      return rms((-(speed / fit.stribeck_speed).array().square()).exp().matrix());
    case FrictionTerm::motor_inertia:
      return rms(signals.acceleration.col(joint));
    case FrictionTerm::load:
      return rms(signals.torque.col(joint));
    default:
      return 1.0;
  }
}

}  // namespace

void doubt_unexplained_torque(RobotIdentification& found) {
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    JointFit& joint = found.fit.joints[j];
    const double share = std::clamp(joint.train.relative / kUsualError - 1.0, 0.0, 1.0);
    if (!(share > 0.0)) continue;
    const double torque = share * joint.train.rms;
    for (std::vector<FittedTerm>* terms : {&joint.friction, &joint.equivalent}) {
      for (FittedTerm& term : *terms) {
        const double size = size_of(term.term, joint, found.signals, static_cast<Eigen::Index>(j));
        if (size > 0.0) term.std = std::hypot(term.std, torque / size);
      }
    }
    found.notes.push_back(fmt::format(
        "joint {}: {:.0f} % of its torque ({:.2g} N m rms) is not explained; the stds of its "
        "friction contain that: check the stamps and units of the log, and the description",
        joint.name, 100.0 * joint.train.relative, joint.train.rms));
  }
}

}  // namespace pcavr
