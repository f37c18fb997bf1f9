// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

#include "robots/robot_identification/block_system.hpp"

namespace pcavr {

/// Candidates for the sign of Coulomb friction: each smoothing speed, then each presliding
/// displacement.
[[nodiscard]] const std::vector<SignModel>& sign_models();

/// Speed of the sign in published identifications [rad/s].
inline constexpr double kPlainSmoothing = 0.05;
/// Candidates for Stribeck's speed [rad/s].
inline constexpr std::array<double, 3> kStribeckSpeeds{0.05, 0.15, 0.5};

/// A column of the friction library: a term, and which of the candidates it has.
struct LibraryColumn {
  FrictionTerm term;
  std::size_t candidate = 0;
};

/// Offset, viscous, motor inertia, and Coulomb friction with each of the sign models.
[[nodiscard]] const std::vector<LibraryColumn>& sign_library();
/// The columns of all terms, Stribeck's with each speed.
[[nodiscard]] const std::vector<LibraryColumn>& full_library();
/// The first column of a term.
[[nodiscard]] int column_of(const std::vector<LibraryColumn>& library, FrictionTerm term,
                            std::size_t candidate = 0);

/// The rows of all joints with the rigid regressor; weights 1, libraries empty.
[[nodiscard]] std::vector<JointRows> rigid_rows(const JointSignals& signals,
                                                const RobotModel& model);

struct LibraryInput {
  const JointSignals& signals;
  std::size_t joint = 0;
  Eigen::VectorXd load;  ///< [N m] rigid-body torque; not used by the sign library
  SignModel sign = {};   ///< not used by the sign library
};
[[nodiscard]] Eigen::MatrixXd library_columns(const std::vector<LibraryColumn>& library,
                                              const LibraryInput& input);

}  // namespace pcavr
