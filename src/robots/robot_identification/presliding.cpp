// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/presliding.hpp"

#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

PreslidingSign::PreslidingSign(double displacement, double start)
    : displacement_(displacement), value_(start) {
  PCAVR_REQUIRE(displacement > 0.0 && std::abs(start) <= 1.0, displacement, start);
}

double PreslidingSign::move(double step) {
  const double towards = std::copysign(1.0, step);
  value_ = towards + (value_ - towards) * std::exp(-std::abs(step) / displacement_);
  return value_;
}

double PreslidingSign::slope(double direction) const {
  return (1.0 - value_ * std::copysign(1.0, direction)) / displacement_;
}

Eigen::VectorXd presliding_sign(const Eigen::VectorXd& position, double displacement) {
  Eigen::VectorXd signs = Eigen::VectorXd::Zero(position.size());
  PreslidingSign sign(displacement);
  for (Eigen::Index i = 1; i < position.size(); ++i) {
    signs[i] = sign.move(position[i] - position[i - 1]);
  }
  return signs;
}

}  // namespace pcavr
