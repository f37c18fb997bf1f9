// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "pcavr/base/core/check.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {
namespace {

constexpr double kCertain = 3.0;  ///< std of a lag

struct TermText {
  const char* name;
  const char* unit;
};

TermText text_of(FrictionTerm term) {
  switch (term) {
    case FrictionTerm::offset:
      return {"offset", "N m"};
    case FrictionTerm::viscous:
      return {"viscous", "N m s/rad"};
    case FrictionTerm::coulomb:
      return {"coulomb", "N m"};
    case FrictionTerm::motor_inertia:
      return {"motor_inertia", "kg m^2"};
    case FrictionTerm::stribeck:
      return {"stribeck", "N m"};
    case FrictionTerm::load:
      return {"load", ""};
    case FrictionTerm::quadratic:
      return {"quadratic", "N m s^2/rad^2"};
    case FrictionTerm::asymmetric:
      return {"asymmetric", "N m s/rad"};
    case FrictionTerm::ripple_sin:
      return {"ripple_sin", "N m"};
    case FrictionTerm::ripple_cos:
      return {"ripple_cos", "N m"};
  }
  PCAVR_REQUIRE(false, static_cast<int>(term));
}

/// The filtered signs of a candidate. Throws ContractError if it is none of them.
template <std::size_t Count>
const Eigen::MatrixXd& sign_of(double candidate, const std::array<double, Count>& candidates,
                               const std::array<Eigen::MatrixXd, Count>& signs) {
  const auto found = std::find(candidates.begin(), candidates.end(), candidate);
  PCAVR_REQUIRE(found != candidates.end(), candidate);
  return signs[static_cast<std::size_t>(found - candidates.begin())];
}

}  // namespace

const char* name_of(FrictionTerm term) { return text_of(term).name; }
const char* unit_of(FrictionTerm term) { return text_of(term).unit; }

double JointFit::value_of(FrictionTerm term) const {
  for (const FittedTerm& entry : friction) {
    if (entry.term == term) return entry.value;
  }
  return 0.0;
}

bool JointFit::seems_out_of_step(double usual) const {
  return std::abs(torque_lag.value) > std::max(usual, kCertain * torque_lag.std);
}

double JointFit::visible_lag(double usual) const {
  constexpr double kOf98Percent = 2.0;  // std, on one side
  return std::max(usual, kCertain * torque_lag.std) + kOf98Percent * torque_lag.std;
}

bool JointFit::is_out_of_step(double usual) const {
  constexpr double kConfirmed = 2.0;  // std
  return seems_out_of_step(usual) &&
         std::copysign(sliding_lag.value, torque_lag.value * sliding_lag.value) >
             kConfirmed * sliding_lag.std;
}

Eigen::VectorXd friction_sign(const SignModel& model, const JointSignals& signals,
                              std::size_t joint) {
  const auto column = static_cast<Eigen::Index>(joint);
  if (model.presliding_displacement > 0.0) {
    return sign_of(model.presliding_displacement, kPreslidingDisplacements, signals.presliding_sign)
        .col(column);
  }
  if (model.is_filtered) {
    return sign_of(model.smoothing_speed, kSmoothingSpeeds, signals.smoothed_sign).col(column);
  }
  return (signals.velocity.col(column).array() / model.smoothing_speed).tanh();
}

FrictionSign::FrictionSign(const SignModel& model, double start)
    : smoothing_speed_(model.smoothing_speed) {
  if (model.presliding_displacement > 0.0) {
    presliding_.emplace(model.presliding_displacement, std::clamp(start, -1.0, 1.0));
  }
}

void FrictionSign::move(double step) {
  if (presliding_) presliding_->move(step);
}

double FrictionSign::slope(double towards) const {
  return presliding_ ? presliding_->slope(towards) : 0.0;
}

double FrictionSign::at(double v) const {
  return presliding_ ? presliding_->value() : std::tanh(v / smoothing_speed_);
}

double friction_torque(const JointFit& joint, double q, double v, double load) {
  return friction_torque(joint, q, v, load, std::tanh(v / joint.sign.smoothing_speed));
}

double friction_torque(const JointFit& joint, double q, double v, double load, double sign) {
  double torque = joint.value_of(FrictionTerm::offset) + joint.value_of(FrictionTerm::viscous) * v +
                  joint.value_of(FrictionTerm::coulomb) * sign +
                  joint.value_of(FrictionTerm::load) * std::abs(load) * sign +
                  joint.value_of(FrictionTerm::quadratic) * v * std::abs(v) +
                  joint.value_of(FrictionTerm::asymmetric) * std::abs(v) +
                  joint.value_of(FrictionTerm::ripple_sin) * std::sin(q) +
                  joint.value_of(FrictionTerm::ripple_cos) * std::cos(q);
  if (const double stribeck = joint.value_of(FrictionTerm::stribeck); stribeck != 0.0) {
    const double ratio = v / joint.stribeck_speed;
    torque += stribeck * sign * std::exp(-ratio * ratio);
  }
  return torque;
}

}  // namespace pcavr
