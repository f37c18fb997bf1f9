// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr::detail {

/// solref and solimp of a MuJoCo contact in its direct format.
struct MujocoContact {
  std::array<double, 2> solref{};  ///< both negative: stiffness and damping
  std::array<double, 5> solimp{};  ///< dmin, dmax, width, midpoint, power
};

/// [N] MuJoCo's force at rest at a depth [m], where `weight` [1/kg] is the sum of both bodies'
/// translational inverse weights: K(r) r, K = s d(r)^2 / (dmax^2 (1 - d(r)) weight) [MuJoCo's
/// documentation, "Solver parameters"].
[[nodiscard]] double mujoco_force(const MujocoContact& contact, double depth, double weight);

/// Impedance d of contacts with the tip. A contact has an apparent mass of d / (1 - d) over
/// `weight`, which moves with the penetration and would feed oscillations: a body pushed at 50 mm/s
/// lost contact at d = 0.5.
inline constexpr double kContactImpedance = 0.1;

/// Stiffness [N/m] and damping [N s/m], exactly, by a constant impedance.
[[nodiscard]] MujocoContact linear_contact(double stiffness, double damping, double weight,
                                           double impedance);

/// The contact law. With an exponent of 1 exactly; else the solimp of the smallest maximum error
/// from a quarter of the depth under `working_force` [N] to one and a half times it, exact at that
/// depth. The damping is that at this depth.
[[nodiscard]] MujocoContact fit_mujoco_contact(const HuntCrossley& law, double working_force,
                                               double weight);

/// Maximum relative error of the force over these depths.
[[nodiscard]] double error_of(const MujocoContact& contact, const HuntCrossley& law,
                              double working_force, double weight);

}  // namespace pcavr::detail
