// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/planar_slider.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pcavr/base/core/solvers.hpp"

#include "quartic.hpp"

namespace pcavr {
namespace {

/// [fx fy m] or [vx vy omega] rotated by an angle about the vertical.
Eigen::Vector3d rotated(const Eigen::Vector3d& vector, double angle) noexcept {
  Eigen::Vector3d result = vector;
  result.head<2>() = Eigen::Rotation2Dd(angle) * vector.head<2>();
  return result;
}

/// Residual of the KKT conditions: metric (target - u) is `multiplier` times the surface's normal
/// at u, and u is on the surface.
struct Residual {
  detail::QuarticValue quartic;
  Eigen::Vector4d value;

  Residual(const LimitSurface& surface, const Eigen::Vector3d& metric,
           const Eigen::Vector3d& target, const Eigen::Vector3d& u, double multiplier) noexcept
      : quartic(detail::evaluate_quartic(surface.coefficients, u)) {
    value.head<3>() = metric.cwiseProduct(target - u) - multiplier * quartic.gradient;
    value[3] = 1.0 - quartic.value;
  }
};

/// A wrench on the surface in its units, and the Lagrange multiplier of that constraint.
struct Projection {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  double multiplier = 0.0;
  bool has_converged = false;
};

/// Damped Newton's method on the Karush-Kuhn-Tucker (KKT) conditions, from the radial point: a few
/// iterations unless the surface is extremely elongated.
Projection project_by_newton(const LimitSurface& surface, const Eigen::Vector3d& metric,
                             const Eigen::Vector3d& target, double target_level) noexcept {
  Projection p;
  p.u = target / target_level;
  const Eigen::Vector3d normal = detail::evaluate_quartic(surface.coefficients, p.u).gradient;
  p.multiplier = normal.dot(metric.cwiseProduct(target - p.u)) / normal.squaredNorm();
  const double tolerance = 1e-11 * (1.0 + target.norm());
  Residual residual(surface, metric, target, p.u, p.multiplier);
  for (int i = 0; i < 30 && residual.value.norm() > tolerance; ++i) {
    // The multiplier is eliminated (Schur complement): the rest is small, and positive definite.
    Eigen::Matrix3d curvature = p.multiplier * residual.quartic.hessian;
    curvature.diagonal() += metric;
    const Eigen::Matrix3d inverse = curvature.inverse();
    const Eigen::Vector3d& gradient = residual.quartic.gradient;
    const Eigen::Vector3d along = inverse * gradient;
    const Eigen::Vector3d across = inverse * residual.value.head<3>();
    Eigen::Vector4d step;
    step[3] = (gradient.dot(across) - residual.value[3]) / gradient.dot(along);
    step.head<3>() = across - step[3] * along;
    const double size = residual.value.norm();
    for (int halving = 0; halving < 12; ++halving, step *= 0.5) {
      residual = Residual(surface, metric, target, p.u + step.head<3>(), p.multiplier + step[3]);
      if (residual.value.norm() < size) break;
    }
    p.u += step.head<3>();
    p.multiplier += step[3];
  }
  p.has_converged = residual.value.norm() <= tolerance && p.multiplier >= 0.0;
  return p;
}

constexpr int kMaxHalvings = 40;  // 2^-40 of a step: below it, rounding decides

/// The minimum of half the squared distance to `target` plus multiplier times H: strictly convex.
Eigen::Vector3d minimise_penalised(const LimitSurface& surface, const Eigen::Vector3d& metric,
                                   const Eigen::Vector3d& target, double multiplier,
                                   Eigen::Vector3d u) noexcept {
  const auto cost = [&](const Eigen::Vector3d& at) {
    return 0.5 * metric.dot((target - at).cwiseAbs2()) +
           multiplier * detail::evaluate_quartic(surface.coefficients, at).value;
  };
  for (int i = 0; i < 50; ++i) {
    const Residual residual(surface, metric, target, u, multiplier);
    const Eigen::Vector3d slope = residual.value.head<3>();
    if (!(slope.norm() > 1e-13 * (1.0 + target.norm()))) break;
    Eigen::Matrix3d curvature = multiplier * residual.quartic.hessian;
    curvature.diagonal() += metric;
    Eigen::Vector3d step = curvature.ldlt().solve(slope);
    const double before = cost(u);
    int halving = 0;
    for (; halving < kMaxHalvings && cost(u + step) > before; ++halving) step *= 0.5;
    if (halving == kMaxHalvings) break;  // as low as rounding allows
    u += step;
  }
  return u;
}

/// The slow method, which always converges: bisection, as H decreases with its multiplier.
Projection project_by_bisection(const LimitSurface& surface, const Eigen::Vector3d& metric,
                                const Eigen::Vector3d& target) noexcept {
  double low = -700.0;  // of the multiplier's logarithm: the range of double
  double high = 700.0;
  Projection p;
  p.u = target;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    p.u = minimise_penalised(surface, metric, target, std::exp(middle), target);
    (detail::evaluate_quartic(surface.coefficients, p.u).value > 1.0 ? low : high) = middle;
  }
  return p;
}

/// Projects `target`, which lies outside, on the surface: its nearest point in the diagonal metric
/// given.
Eigen::Vector3d project(const LimitSurface& surface, const Eigen::Vector3d& metric,
                        const Eigen::Vector3d& target, double target_level) noexcept {
  const Eigen::Vector3d weights = metric / metric.maxCoeff();
  const Projection fast = project_by_newton(surface, weights, target, target_level);
  return fast.has_converged ? fast.u : project_by_bisection(surface, weights, target).u;
}

FrictionPhase phase_at_rest(const PlanarFriction& friction, double load_level) noexcept {
  return load_level < friction.static_to_kinetic_ratio - friction.static_to_kinetic_std
             ? FrictionPhase::static_contact
             : FrictionPhase::critical;
}

/// A step at rest under a load that friction balances.
PlanarStep rest(const PlanarFriction& friction, const PlanarState& state,
                const Eigen::Vector3d& load, double load_level) noexcept {
  PlanarStep step;
  step.state = state;
  step.state.twist.setZero();
  step.state.phase = phase_at_rest(friction, load_level);
  const double limit = std::max(friction.static_to_kinetic_ratio, 1.0);
  step.friction = load_level > limit ? Eigen::Vector3d(-load * limit / load_level) : -load;
  return step;
}

void advance(PlanarState& state, const Eigen::Vector3d& mean_twist, double time) noexcept {
  state.position += time * mean_twist.head<2>();
  state.yaw += time * mean_twist.z();
}

}  // namespace

PlanarStep step_planar(const PlanarFriction& friction, const PlanarState& state,
                       const Eigen::Vector3d& load, double dt) noexcept {
  const bool is_moving = !state.twist.isZero(0.0);
  const double axes = state.yaw + 0.5 * dt * state.twist.z();  // in the middle of the step
  const Eigen::Vector3d load_body = rotated(load, -axes);
  const double load_level = level(friction.sliding, load_body);
  if (!load.allFinite() || !(dt > 0.0)) return rest(friction, state, Eigen::Vector3d::Zero(), 0.0);
  if (!is_moving && load_level <= std::max(friction.static_to_kinetic_ratio, 1.0)) {
    return rest(friction, state, load, load_level);
  }

  const Eigen::Vector3d mass(friction.mass, friction.mass, friction.inertia);
  const Eigen::Vector3d drag(friction.viscous, friction.viscous, friction.viscous_turning);
  const Eigen::Vector3d before = rotated(state.twist, -axes);
  // The level of the wrench that would stop the body within the step.
  const double stopping_level = level(friction.sliding, load_body + mass.cwiseProduct(before) / dt);
  if (stopping_level <= 1.0) {
    PlanarStep step = rest(friction, state, load, load_level);
    // It needs that share of the step to stop, at half its speed on average.
    advance(step.state, 0.5 * state.twist, dt * stopping_level);
    return step;
  }

  // Implicit midpoint: M (mean - before) / (dt / 2) = load - drag mean - friction.
  const Eigen::Vector3d inertia = 2.0 * mass / dt + drag;
  const Eigen::Vector3d pushing = load_body + 2.0 * mass.cwiseProduct(before) / dt;
  const double pushing_level = level(friction.sliding, pushing);
  Eigen::Vector3d friction_wrench = pushing;
  if (pushing_level > 1.0) {
    const Eigen::Vector3d scale = detail::scale_of(friction.sliding);
    friction_wrench = scale.cwiseProduct(project(friction.sliding,
                                                 scale.cwiseProduct(scale).cwiseQuotient(inertia),
                                                 pushing.cwiseQuotient(scale), pushing_level));
  }
  const Eigen::Vector3d mean = (pushing - friction_wrench).cwiseQuotient(inertia);
  PlanarStep step;
  step.state = state;
  step.state.twist = rotated(2.0 * mean - before, axes);
  step.state.phase = FrictionPhase::sliding;
  step.friction = rotated(-friction_wrench - drag.cwiseProduct(mean), axes);
  advance(step.state, rotated(mean, axes), dt);
  return step;
}

}  // namespace pcavr
