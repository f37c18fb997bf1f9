// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "pcavr/physics/contact/contact_law.hpp"
#include "pcavr/physics/contact/damping.hpp"

namespace pcavr {

/// One impact of a free mass on a fixed body, from touch to separation.
struct Impact {
  bool has_separated =
      false;                 ///< false: it came to rest in contact, or the inputs are not physical
  double restitution = 0.0;  ///< speed after over speed before
  double duration = 0.0;     ///< [s]
  double max_penetration = 0.0;  ///< [m]
  double force_width = 0.0;      ///< [s] std of the force's distribution over time
};

/// Integrates m x'' = -F from x = 0, x' = approach_speed by an adaptive fifth-order Runge-Kutta
/// method [Dormand & Prince 1980] of relative error 1e-11 a step, until the bodies separate or the
/// force would pull. mass [kg] > 0, approach_speed [m/s] > 0. Does not allocate or throw.
[[nodiscard]] Impact simulate_impact(const ContactLaw& law, double mass,
                                     double approach_speed) noexcept;

/// The error of a damping law's restitution [paper B, eq. 12].
struct DampingScore {
  DampingLaw law = DampingLaw::exact;
  double relative_error = 0.0;  ///< (c_M - c) / c, with c_M the simulated restitution
};

/// The score of one law at restitution c in (0, 1), by one simulated impact.
[[nodiscard]] DampingScore score_damping_law(DampingLaw law, double restitution) noexcept;

/// The score of each published law at restitution c in (0, 1), in the order of
/// kPublishedDampingLaws, by one simulated impact each. The score depends on c only.
[[nodiscard]] std::array<DampingScore, kPublishedDampingLaws.size()> score_damping_laws(
    double restitution) noexcept;

/// The published law of the smallest |relative error| at restitution c in (0, 1).
[[nodiscard]] DampingScore best_published_damping_law(double restitution) noexcept;

}  // namespace pcavr
