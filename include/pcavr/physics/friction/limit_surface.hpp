// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace pcavr {

/// The limit surface of a body on a plane [Goyal, Ruina & Papadopoulos 1991]: the set of wrenches
/// that friction can bear. A wrench on it makes the body slide along the surface's normal there.
///
/// Axes: fixed to the body, origin at its centre of mass (or any point, kept the same throughout).
/// A wrench is [fx fy m] [N, N, N m], a twist [vx vy omega] [m/s, m/s, rad/s]; the wrench meant is
/// what pushes the body, so that it and the twist form no obtuse angle. Pure functions: any thread
/// may call any function; nothing allocates or throws.
///
/// Represented as a homogeneous quartic H = 1 in u = [fx/F, fy/F, m/(F L)], after Zhou, Paolini,
/// Bagnell & Mason (2016). The ellipsoid [Howe & Cutkosky 1996] is the quartic that is a square.
struct LimitSurface {
  double force = 1.0;   ///< F [N], > 0: the scale of forces; scaling it scales the whole surface
  double length = 0.1;  ///< L [m], > 0: the scale of moments over forces
  /// Coefficients of H, in the order of kQuarticExponents. H must be convex, and positive away from
  /// 0.
  std::array<double, 15> coefficients{};
};

/// The powers of u's three components that each coefficient multiplies.
inline constexpr std::array<std::array<int, 3>, 15> kQuarticExponents{{{4, 0, 0},
                                                                       {3, 1, 0},
                                                                       {3, 0, 1},
                                                                       {2, 2, 0},
                                                                       {2, 1, 1},
                                                                       {2, 0, 2},
                                                                       {1, 3, 0},
                                                                       {1, 2, 1},
                                                                       {1, 1, 2},
                                                                       {1, 0, 3},
                                                                       {0, 4, 0},
                                                                       {0, 3, 1},
                                                                       {0, 2, 2},
                                                                       {0, 1, 3},
                                                                       {0, 0, 4}}};

/// (f / max_force)^2 + (m / max_moment)^2 = 1, with m about `centre` [m], the point about which the
/// body spins freely. max_force [N] > 0, max_moment [N m] > 0 (see mean_radius).
[[nodiscard]] LimitSurface ellipsoid_surface(
    double max_force, double max_moment,
    const Eigen::Vector2d& centre = Eigen::Vector2d::Zero()) noexcept;

/// The surface u^T A u = 1, A positive definite, in the scales given.
[[nodiscard]] LimitSurface quadratic_surface(double force, double length,
                                             const Eigen::Matrix3d& a) noexcept;

/// The wrench's distance relative to the surface: below 1 the body stays static, 1 is on the
/// surface; proportional to the wrench.
[[nodiscard]] double level(const LimitSurface& surface, const Eigen::Vector3d& wrench) noexcept;

/// The unit-free direction of the twist that `wrench` causes: the outward normal, not normalised;
/// depends on the wrench's direction only up to its length. Zero for a zero wrench.
[[nodiscard]] Eigen::Vector3d sliding_direction(const LimitSurface& surface,
                                                const Eigen::Vector3d& wrench) noexcept;

/// The wrench on the surface that sustains `twist`: of all that friction can bear, the one of
/// maximum dissipation (the maximum power inequality). Zero for a zero twist. Friction itself acts
/// on the body with its opposite.
[[nodiscard]] Eigen::Vector3d sliding_load(const LimitSurface& surface,
                                           const Eigen::Vector3d& twist) noexcept;

/// Angle [rad] between two twists, where a turn of 1 rad counts as `length` metres [m].
[[nodiscard]] double twist_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 double length) noexcept;

}  // namespace pcavr
