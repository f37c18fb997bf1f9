// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/physical_fit.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

using Vector10d = Eigen::Matrix<double, 10, 1>;

Vector10d sphere(double mass) {
  Vector10d p = Vector10d::Zero();
  p[0] = mass;
  p[4] = p[7] = p[9] = 0.01 * mass;
  return p;
}

TEST(PhysicalFit, KeepsAPossibleBody) {
  Eigen::VectorXd centre = sphere(2.0);
  centre[1] = 0.05;
  const Eigen::MatrixXd information = 1e8 * Eigen::MatrixXd::Identity(10, 10);
  const Eigen::VectorXd x = fit_physical(centre, information, sphere(3.0), 1);
  EXPECT_LT((x - centre).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(PhysicalFit, MovesANegativeMassToTheBorderOfThePossible) {
  Eigen::VectorXd centre(11);
  centre << sphere(-1.0), 7.0;
  const Eigen::MatrixXd information = 1e6 * Eigen::MatrixXd::Identity(11, 11);
  Eigen::VectorXd start(11);
  start << sphere(3.0), 0.0;
  const Eigen::VectorXd x = fit_physical(centre, information, start, 1);
  EXPECT_GT(physical_margin(x.head<10>()), 0.0);
  EXPECT_NEAR(x[0], 0.0, 0.01);
  EXPECT_NEAR(x[10], 7.0, 1e-6);
}

TEST(PhysicalMargin, IsNegativeWhereTheTriangleInequalityIsViolated) {
  Vector10d p = sphere(1.0);
  EXPECT_GT(physical_margin(p), 0.0);
  p[9] = 0.03;
  EXPECT_LT(physical_margin(p), 0.0);
}

}  // namespace
}  // namespace pcavr
