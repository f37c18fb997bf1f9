// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

/// The combinations of inertial parameters that act on the joints' torques at all: columns of the
/// regressor over random states that are independent of those before them, each with what of the
/// dependent columns goes into it [Gautier 1991, by QR]. Values and stds from the parameters' own
/// and their covariance; excited where the std is below half the prior's.
[[nodiscard]] std::vector<BaseParameter> base_parameters(const RobotModel& model,
                                                         const Eigen::VectorXd& parameters,
                                                         const Eigen::MatrixXd& covariance,
                                                         const Eigen::VectorXd& prior_std);

}  // namespace pcavr
