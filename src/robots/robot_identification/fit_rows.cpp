// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/fit_rows.hpp"

#include "pcavr/base/core/check.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"

namespace pcavr {
namespace {

Eigen::VectorXd column(const LibraryColumn& entry, const LibraryInput& in,
                       const Eigen::VectorXd& sign) {
  const auto j = static_cast<Eigen::Index>(in.joint);
  const auto v = in.signals.velocity.col(j).array();
  switch (entry.term) {
    case FrictionTerm::offset:
      return Eigen::VectorXd::Ones(v.size());
    case FrictionTerm::viscous:
      return v;
    case FrictionTerm::coulomb:
      return sign;
    case FrictionTerm::motor_inertia:
      return in.signals.acceleration.col(j);
    case FrictionTerm::stribeck:
      return sign.array() * (-(v / kStribeckSpeeds[entry.candidate]).square()).exp();
    case FrictionTerm::load:
      return sign.array() * in.load.array().abs();
    case FrictionTerm::quadratic:
      return v * v.abs();
    case FrictionTerm::asymmetric:
      return v.abs();
    case FrictionTerm::ripple_sin:
      return in.signals.position.col(j).array().sin();
    case FrictionTerm::ripple_cos:
      return in.signals.position.col(j).array().cos();
  }
  PCAVR_REQUIRE(false, static_cast<int>(entry.term));
}

std::vector<SignModel> make_sign_models() {
  std::vector<SignModel> models;
  models.reserve(kSmoothingSpeeds.size() + kPreslidingDisplacements.size());
  for (const double speed : kSmoothingSpeeds) {
    models.push_back({.smoothing_speed = speed, .is_filtered = true});
  }
  for (const double displacement : kPreslidingDisplacements) {
    models.push_back({.presliding_displacement = displacement});
  }
  return models;
}

std::vector<LibraryColumn> make_sign_library() {
  std::vector<LibraryColumn> library{
      {FrictionTerm::offset}, {FrictionTerm::viscous}, {FrictionTerm::motor_inertia}};
  for (std::size_t k = 0; k < sign_models().size(); ++k) {
    library.push_back({FrictionTerm::coulomb, k});
  }
  return library;
}

std::vector<LibraryColumn> make_full_library() {
  std::vector<LibraryColumn> library{{FrictionTerm::offset},
                                     {FrictionTerm::viscous},
                                     {FrictionTerm::coulomb},
                                     {FrictionTerm::motor_inertia}};
  for (std::size_t k = 0; k < kStribeckSpeeds.size(); ++k) {
    library.push_back({FrictionTerm::stribeck, k});
  }
  for (const FrictionTerm term :
       {FrictionTerm::load, FrictionTerm::quadratic, FrictionTerm::asymmetric,
        FrictionTerm::ripple_sin, FrictionTerm::ripple_cos}) {
    library.push_back({term});
  }
  return library;
}

}  // namespace

const std::vector<SignModel>& sign_models() {
  static const std::vector<SignModel> models = make_sign_models();
  return models;
}

const std::vector<LibraryColumn>& sign_library() {
  static const std::vector<LibraryColumn> library = make_sign_library();
  return library;
}

const std::vector<LibraryColumn>& full_library() {
  static const std::vector<LibraryColumn> library = make_full_library();
  return library;
}

int column_of(const std::vector<LibraryColumn>& library, FrictionTerm term, std::size_t candidate) {
  for (std::size_t i = 0; i < library.size(); ++i) {
    if (library[i].term == term && library[i].candidate == candidate) return static_cast<int>(i);
  }
  PCAVR_REQUIRE(false, static_cast<int>(term), candidate);
}

std::vector<JointRows> rigid_rows(const JointSignals& signals, const RobotModel& model) {
  const Eigen::Index rows = signals.position.rows();
  const auto dof = static_cast<Eigen::Index>(model.dof);
  PCAVR_REQUIRE(dof == signals.position.cols() && !model.has_mimic_joints(), dof);
  std::vector<JointRows> joints(model.dof);
  for (Eigen::Index j = 0; j < dof; ++j) {
    JointRows& joint = joints[static_cast<std::size_t>(j)];
    joint.rigid.resize(rows, 10 * dof);
    joint.torque = signals.torque.col(j);
    joint.weight.setOnes(rows);
  }
  RobotDynamics dynamics(model);
  Eigen::MatrixXd regressor(dof, 10 * dof);
  Eigen::VectorXd q(dof), dq(dof), ddq(dof);
  for (Eigen::Index row = 0; row < rows; ++row) {
    q = signals.position.row(row).transpose();
    dq = signals.velocity.row(row).transpose();
    ddq = signals.acceleration.row(row).transpose();
    dynamics.regressor(q, dq, ddq, regressor);
    for (Eigen::Index j = 0; j < dof; ++j) {
      joints[static_cast<std::size_t>(j)].rigid.row(row) = regressor.row(j);
    }
  }
  return joints;
}

Eigen::MatrixXd library_columns(const std::vector<LibraryColumn>& library,
                                const LibraryInput& input) {
  Eigen::MatrixXd columns(input.signals.velocity.rows(), static_cast<Eigen::Index>(library.size()));
  const bool is_sign_library = &library == &sign_library();
  Eigen::VectorXd sign;
  if (!is_sign_library) sign = friction_sign(input.sign, input.signals, input.joint);
  for (std::size_t i = 0; i < library.size(); ++i) {
    if (is_sign_library && library[i].term == FrictionTerm::coulomb) {
      sign = friction_sign(sign_models()[library[i].candidate], input.signals, input.joint);
    }
    columns.col(static_cast<Eigen::Index>(i)) = column(library[i], input, sign);
  }
  return columns;
}

}  // namespace pcavr
