// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/robot_motion.hpp"

#include "pcavr/base/core/check.hpp"

namespace pcavr {

RobotMotion::RobotMotion(const RobotModel& model) : dynamics_(model) {
  const auto dof = static_cast<Eigen::Index>(model.dof);
  for (Eigen::VectorXd* v : {&q_, &dq_, &ddq_, &dq_sum_, &ddq_sum_}) v->setZero(dof);
}

void RobotMotion::step(const Eigen::Ref<const Eigen::VectorXd>& tau, double dt,
                       Eigen::Ref<Eigen::VectorXd> q, Eigen::Ref<Eigen::VectorXd> dq) {
  PCAVR_REQUIRE(dt > 0.0, dt);
  PCAVR_REQUIRE(q.size() == q_.size() && dq.size() == q_.size(), q.size(), dq.size(), q_.size());
  // Fractions of the step at which the slope is evaluated, and its weights in the sum.
  constexpr double kFractions[] = {0.0, 0.5, 0.5, 1.0};
  constexpr double kWeights[] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  dq_sum_.setZero();
  ddq_sum_.setZero();
  for (int stage = 0; stage < 4; ++stage) {
    const double h = kFractions[stage] * dt;
    // Both use the slopes of the stage before: the position first, as its slope is dq_.
    q_ = q + h * dq_;
    dq_ = dq + h * ddq_;
    dynamics_.forward_dynamics(q_, dq_, tau, ddq_);
    dq_sum_ += kWeights[stage] * dq_;
    ddq_sum_ += kWeights[stage] * ddq_;
  }
  q += dt * dq_sum_;
  dq += dt * ddq_sum_;
}

}  // namespace pcavr
