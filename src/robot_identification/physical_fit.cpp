// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_identification/physical_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>

#include "pcavr/core/check.hpp"

namespace pcavr {
namespace {

using Vector10d = Eigen::Matrix<double, 10, 1>;

/// The pseudo-inertia: second moments of the mass, first moments, mass.
Eigen::Matrix4d pseudo_inertia(const Vector10d& p) {
  Eigen::Matrix3d inertia;
  inertia << p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9];
  Eigen::Matrix4d pseudo;
  pseudo.topLeftCorner<3, 3>() = 0.5 * inertia.trace() * Eigen::Matrix3d::Identity() - inertia;
  pseudo.topRightCorner<3, 1>() = p.segment<3>(1);
  pseudo.bottomLeftCorner<1, 3>() = p.segment<3>(1).transpose();
  pseudo(3, 3) = p[0];
  return pseudo;
}

Vector10d parameters_of(const Eigen::Matrix4d& pseudo) {
  const Eigen::Matrix3d moments = pseudo.topLeftCorner<3, 3>();
  const Eigen::Matrix3d inertia = moments.trace() * Eigen::Matrix3d::Identity() - moments;
  Vector10d p;
  p << pseudo(3, 3), pseudo.topRightCorner<3, 1>(), inertia(0, 0), inertia(0, 1), inertia(0, 2),
      inertia(1, 1), inertia(1, 2), inertia(2, 2);
  return p;
}

/// What the exponentials of the diagonal are added to: a body of 1 kg then extends 1 mm at least,
/// and has 0.1 g. Without it, fits at the border of the possible run to minus infinity.
constexpr std::array<double, 4> kMinDiagonal{1e-3, 1e-3, 1e-3, 1e-2};
/// Beyond it nothing is finite any more.
constexpr double kMaxLog = 50.0;

/// Lower triangle with the logarithms of its diagonal, row by row.
Eigen::Matrix4d factor_of(const double* logs) {
  Eigen::Matrix4d factor = Eigen::Matrix4d::Zero();
  int k = 0;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < row; ++column) factor(row, column) = logs[k++];
    factor(row, row) = kMinDiagonal[static_cast<std::size_t>(row)] + std::exp(logs[k++]);
  }
  return factor;
}

Vector10d logs_of(const Vector10d& parameters) {
  const Eigen::Matrix4d factor = pseudo_inertia(parameters).llt().matrixL();
  Vector10d logs;
  int k = 0;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < row; ++column) logs[k++] = factor(row, column);
    const double least = kMinDiagonal[static_cast<std::size_t>(row)];
    logs[k++] = std::log(std::max(factor(row, row) - least, least));
  }
  return logs;
}

/// The derivative of a body's parameters by its logs.
Eigen::Matrix<double, 10, 10> derivative(const double* logs) {
  const Eigen::Matrix4d factor = factor_of(logs);
  Eigen::Matrix<double, 10, 10> jacobian;
  int k = 0;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column <= row; ++column) {
      Eigen::Matrix4d change = Eigen::Matrix4d::Zero();
      change(row, column) =
          row == column ? factor(row, row) - kMinDiagonal[static_cast<std::size_t>(row)] : 1.0;
      const Eigen::Matrix4d product = change * factor.transpose();
      jacobian.col(k++) = parameters_of(product + product.transpose());
    }
  }
  return jacobian;
}

/// root' (x - centre), root root' = information.
class PhysicalCost final : public ceres::CostFunction {
 public:
  PhysicalCost(Eigen::VectorXd centre, Eigen::MatrixXd root, Eigen::Index bodies)
      : centre_(std::move(centre)), root_(std::move(root)), bodies_(bodies) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(centre_.size()));
    set_num_residuals(static_cast<int>(centre_.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals,
                double** jacobians) const override {
    const Eigen::Index size = centre_.size();
    if (!(Eigen::Map<const Eigen::VectorXd>(blocks[0], 10 * bodies_).maxCoeff() < kMaxLog)) {
      return false;
    }
    Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(blocks[0], size);
    for (Eigen::Index body = 0; body < bodies_; ++body) {
      const Eigen::Matrix4d factor = factor_of(blocks[0] + 10 * body);
      x.segment<10>(10 * body) = parameters_of(factor * factor.transpose());
    }
    Eigen::Map<Eigen::VectorXd>(residuals, size) = root_.transpose() * (x - centre_);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor> jacobian(jacobians[0], size, size);
    jacobian = root_.transpose();
    for (Eigen::Index body = 0; body < bodies_; ++body) {
      jacobian.middleCols<10>(10 * body) =
          (root_.middleRows<10>(10 * body).transpose() * derivative(blocks[0] + 10 * body)).eval();
    }
    return true;
  }

 private:
  Eigen::VectorXd centre_;
  Eigen::MatrixXd root_;
  Eigen::Index bodies_;
};

}  // namespace

double physical_margin(const Vector10d& parameters) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(pseudo_inertia(parameters));
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  return largest > 0.0 ? solver.eigenvalues()[0] / largest : 0.0;
}

Eigen::VectorXd fit_physical(const Eigen::VectorXd& centre, const Eigen::MatrixXd& information,
                             const Eigen::VectorXd& start, Eigen::Index bodies) {
  const Eigen::LLT<Eigen::MatrixXd> factors(information);
  PCAVR_REQUIRE(factors.info() == Eigen::Success, information.rows());
  Eigen::VectorXd x = start;
  for (Eigen::Index body = 0; body < bodies; ++body) {
    x.segment<10>(10 * body) = logs_of(start.segment<10>(10 * body));
  }
  ceres::Problem problem;
  problem.AddResidualBlock(new PhysicalCost(centre, factors.matrixL(), bodies), nullptr, x.data());
  ceres::Solver::Options options;
  options.max_num_iterations = 200;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (Eigen::Index body = 0; body < bodies; ++body) {
    const Eigen::Matrix4d factor = factor_of(x.data() + 10 * body);
    x.segment<10>(10 * body) = parameters_of(factor * factor.transpose());
  }
  return x;
}

}  // namespace pcavr
