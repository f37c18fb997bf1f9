// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/limit_surface.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pcavr/base/core/solvers.hpp"

#include "quartic.hpp"

namespace pcavr {
namespace {

using detail::evaluate_quartic;
using detail::scale_of;

constexpr int kMaxIterations = 60;  // five or six suffice, except in flat regions

double fourth_root(double value) noexcept { return std::sqrt(std::sqrt(std::max(0.0, value))); }

}  // namespace

LimitSurface quadratic_surface(double force, double length, const Eigen::Matrix3d& a) noexcept {
  LimitSurface surface{force, length, {}};
  // (u^T A u)^2, term by term.
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          std::array<int, 3> powers{};
          for (const int index : {i, j, k, l}) ++powers[static_cast<std::size_t>(index)];
          const auto term = std::find(kQuarticExponents.begin(), kQuarticExponents.end(), powers);
          surface.coefficients[static_cast<std::size_t>(term - kQuarticExponents.begin())] +=
              a(i, j) * a(k, l);
        }
      }
    }
  }
  return surface;
}

LimitSurface ellipsoid_surface(double max_force, double max_moment,
                               const Eigen::Vector2d& centre) noexcept {
  const double length = max_moment / max_force;
  // The moment about the centre, m - cx fy + cy fx, in units of max_moment.
  const Eigen::Vector3d moment(centre.y() / length, -centre.x() / length, 1.0);
  Eigen::Matrix3d a = moment * moment.transpose();
  a(0, 0) += 1.0;
  a(1, 1) += 1.0;
  return quadratic_surface(max_force, length, a);
}

double level(const LimitSurface& surface, const Eigen::Vector3d& wrench) noexcept {
  const Eigen::Vector3d u = wrench.cwiseQuotient(scale_of(surface));
  return fourth_root(evaluate_quartic(surface.coefficients, u).value);
}

Eigen::Vector3d sliding_direction(const LimitSurface& surface,
                                  const Eigen::Vector3d& wrench) noexcept {
  const Eigen::Vector3d scale = scale_of(surface);
  const double size = wrench.cwiseQuotient(scale).norm();
  if (!(size > 0.0)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d u = wrench.cwiseQuotient(scale) / size;
  return evaluate_quartic(surface.coefficients, u).gradient.cwiseQuotient(scale) * surface.force;
}

Eigen::Vector3d sliding_load(const LimitSurface& surface, const Eigen::Vector3d& twist) noexcept {
  const Eigen::Vector3d scale = scale_of(surface);
  const Eigen::Vector3d target = twist.cwiseProduct(scale).normalized();
  if (!(target.norm() > 0.0)) return Eigen::Vector3d::Zero();
  // The gradient of H is along the twist where H / 4 - target . u has its only minimum: damped
  // Newton's method (backtracking line search).
  Eigen::Vector3d u = target;
  double cost = evaluate_quartic(surface.coefficients, u).value / 4.0 - target.dot(u);
  for (int i = 0; i < kMaxIterations; ++i) {
    const auto q = evaluate_quartic(surface.coefficients, u);
    const Eigen::Vector3d slope = q.gradient / 4.0 - target;
    if (slope.norm() < 1e-13) break;
    Eigen::Matrix3d curvature = q.hessian / 4.0;
    curvature.diagonal().array() += 1e-12 * curvature.trace();
    const Eigen::Vector3d step = curvature.ldlt().solve(slope);
    double share = 1.0;
    Eigen::Vector3d next = u - step;
    double next_cost = evaluate_quartic(surface.coefficients, next).value / 4.0 - target.dot(next);
    while (next_cost > cost && share > 1e-6) {
      share *= 0.5;
      next = u - share * step;
      next_cost = evaluate_quartic(surface.coefficients, next).value / 4.0 - target.dot(next);
    }
    if (next_cost > cost) break;
    u = next;
    cost = next_cost;
  }
  const double size = fourth_root(evaluate_quartic(surface.coefficients, u).value);
  return size > 0.0 ? Eigen::Vector3d(u.cwiseProduct(scale) / size) : Eigen::Vector3d::Zero();
}

double twist_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double length) noexcept {
  const Eigen::Vector3d scale(1.0, 1.0, length);
  const Eigen::Vector3d p = a.cwiseProduct(scale);
  const Eigen::Vector3d q = b.cwiseProduct(scale);
  return std::atan2(p.cross(q).norm(), p.dot(q));
}

}  // namespace pcavr
