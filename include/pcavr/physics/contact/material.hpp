// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// An elastic material.
struct Material {
  double youngs_modulus = 0.0;  ///< E [Pa], > 0
  double poisson_ratio = 0.0;   ///< nu, in (-1, 0.5]
};

/// Paper B's two: its printed parts, and its end effector.
inline constexpr Material kPolylacticAcid{2.8e9, 0.38};
inline constexpr Material kAluminium{70.0e9, 0.33};

/// Hertz's geometry factor tau [sqrt(m)] of two spheres of the radii given [m]. Radii > 0.
[[nodiscard]] double sphere_on_sphere(double radius_a, double radius_b) noexcept;
/// The same of a sphere on a plane: the limit of an infinite second radius.
[[nodiscard]] double sphere_on_plane(double radius) noexcept;

/// The stiffness k [N/m^1.5] in F = k x^1.5 [Hertz 1882; paper B, eq. 2 and 3].
/// Paper B takes tau = 1, which is a sphere of one metre on a plane.
[[nodiscard]] double hertz_stiffness(const Material& a, const Material& b, double tau) noexcept;

}  // namespace pcavr
