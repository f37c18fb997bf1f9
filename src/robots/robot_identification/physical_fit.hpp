// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr {

/// The smallest eigenvalue of a body's pseudo-inertia over its largest; > 0 where a rigid body can
/// have these ten parameters [Wensing, Kim & Slotine 2018, eq. 7].
[[nodiscard]] double physical_margin(const Eigen::Matrix<double, 10, 1>& parameters);

/// Minimises half (x - centre)' information (x - centre) over x = [inertial parameters, others]
/// such that each of `bodies` has a positive definite pseudo-inertia. The constraint is convex in
/// the parameters: Newton's method with a logarithmic barrier finds the only minimum, within
/// 0.05 a body [Boyd & Vandenberghe 2004, chapter 11]. `start`: possible bodies.
[[nodiscard]] Eigen::VectorXd fit_physical(const Eigen::VectorXd& centre,
                                           const Eigen::MatrixXd& information,
                                           const Eigen::VectorXd& start, Eigen::Index bodies);

}  // namespace pcavr
