// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/physical_fit.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

using Vector10d = Eigen::Matrix<double, 10, 1>;
using Matrix10d = Eigen::Matrix<double, 10, 10>;

/// Weight of the barrier at the end: four times it, a body, is what the minimum may be missed by,
/// in units of a unit variance.
constexpr double kLastBarrier = 0.01;
constexpr double kBarrierStep = 0.2;
constexpr int kMaxNewtonSteps = 50;
constexpr double kConverged = 1e-6;  ///< Newton's decrement

/// The pseudo-inertia: second moments of the mass, first moments, mass. Linear in the parameters.
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

/// The derivative of the pseudo-inertia by each parameter.
const std::array<Eigen::Matrix4d, 10>& pseudo_derivatives() {
  static const std::array<Eigen::Matrix4d, 10> derivatives = [] {
    std::array<Eigen::Matrix4d, 10> all;
    for (int k = 0; k < 10; ++k) {
      all[static_cast<std::size_t>(k)] = pseudo_inertia(Vector10d::Unit(k));
    }
    return all;
  }();
  return derivatives;
}

/// The quadratic cost with the bodies' barriers.
class BarrierCost {
 public:
  BarrierCost(const Eigen::VectorXd& centre, const Eigen::MatrixXd& information,
              Eigen::Index bodies)
      : centre_(centre), information_(information), bodies_(bodies) {}

  /// Infinite where a body is not possible.
  [[nodiscard]] double value(const Eigen::VectorXd& x, double barrier) const {
    double logs = 0.0;
    for (Eigen::Index body = 0; body < bodies_; ++body) {
      const Eigen::LLT<Eigen::Matrix4d> factors(pseudo_inertia(x.segment<10>(10 * body)));
      if (factors.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
      logs += 2.0 * Eigen::Matrix4d(factors.matrixL()).diagonal().array().log().sum();
    }
    const Eigen::VectorXd from_centre = x - centre_;
    return 0.5 * from_centre.dot(information_ * from_centre) - barrier * logs;
  }

  /// Newton's step at a possible x, and its decrement: half of it is what the step may gain.
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& x, double barrier,
                                     double& decrement) const {
    Eigen::MatrixXd hessian = information_;
    Eigen::VectorXd gradient = information_ * (x - centre_);
    for (Eigen::Index body = 0; body < bodies_; ++body) {
      const Eigen::Matrix4d inverse = pseudo_inertia(x.segment<10>(10 * body)).inverse();
      std::array<Eigen::Matrix4d, 10> products;
      for (std::size_t k = 0; k < 10; ++k) {
        products[k] = inverse * pseudo_derivatives()[k];
        gradient[10 * body + static_cast<Eigen::Index>(k)] -= barrier * products[k].trace();
      }
      Matrix10d curvature;
      for (std::size_t k = 0; k < 10; ++k) {
        for (std::size_t l = 0; l < 10; ++l) {
          curvature(static_cast<int>(k), static_cast<int>(l)) =
              products[k].cwiseProduct(products[l].transpose()).sum();
        }
      }
      hessian.block<10, 10>(10 * body, 10 * body) += barrier * curvature;
    }
    const Eigen::VectorXd scale = hessian.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
    const Eigen::VectorXd direction =
        -scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(gradient)));
    decrement = -gradient.dot(direction);
    return direction;
  }

 private:
  const Eigen::VectorXd& centre_;
  const Eigen::MatrixXd& information_;
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
  const BarrierCost cost(centre, information, bodies);
  Eigen::VectorXd x = start;
  // Begins where barrier and cost are of one size.
  double barrier =
      std::max(kLastBarrier, std::abs(cost.value(start, 0.0)) / static_cast<double>(4 * bodies));
  for (bool is_last = false; !is_last; barrier *= kBarrierStep) {
    is_last = barrier <= kLastBarrier;
    for (int k = 0; k < kMaxNewtonSteps; ++k) {
      double decrement = 0.0;
      const Eigen::VectorXd direction = cost.step(x, barrier, decrement);
      if (!(decrement > kConverged * (1.0 + barrier))) break;
      const double before = cost.value(x, barrier);
      double length = 1.0;
      while (length > 1e-12 &&
             !(cost.value(x + length * direction, barrier) <= before - 0.1 * length * decrement)) {
        length *= 0.5;
      }
      if (length <= 1e-12) break;
      x += length * direction;
    }
  }
  return x;
}

}  // namespace pcavr
