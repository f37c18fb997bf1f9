// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/board/lens_slope.hpp"

#include <cmath>

namespace pcavr {
namespace {

/// theta_d = theta (1 + k1 theta^2 + k2 theta^4 + ...), along p.
Eigen::Vector2d fisheye_slope(const Eigen::Vector2d& p, int coefficient) {
  const double r = p.norm();
  if (r < 1e-12) return Eigen::Vector2d::Zero();
  return std::pow(std::atan(r), 2 * coefficient + 3) / r * p;
}

/// k1 k2 p1 p2 k3 k4 k5 k6: radial = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6
/// r^6).
Eigen::Vector2d polynomial_slope(const LensDistortion& lens, const Eigen::Vector2d& p,
                                 int coefficient) {
  const double x = p.x(), y = p.y(), r2 = p.squaredNorm();
  const auto k = lens.coefficients();
  double denominator = 1.0;
  if (lens.model() == LensModel::rational) {
    denominator += r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  }
  const double numerator = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double by_denominator = -numerator / (denominator * denominator);
  switch (coefficient) {
    case 0:
      return r2 / denominator * p;
    case 1:
      return r2 * r2 / denominator * p;
    case 2:
      return {2.0 * x * y, r2 + 2.0 * y * y};
    case 3:
      return {r2 + 2.0 * x * x, 2.0 * x * y};
    case 4:
      return r2 * r2 * r2 / denominator * p;
    default:
      return std::pow(r2, coefficient - 4) * by_denominator * p;
  }
}

}  // namespace

Eigen::Vector2d lens_slope(const LensDistortion& lens, const Eigen::Vector2d& p, int coefficient) {
  return lens.model() == LensModel::fisheye ? fisheye_slope(p, coefficient)
                                            : polynomial_slope(lens, p, coefficient);
}

}  // namespace pcavr
