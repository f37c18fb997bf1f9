// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace pcavr {

/// A body that is pushed along a line over its support: three-phase stick-slip friction, the phase
/// decided by the force [paper C, eq. 8, after Karnopp 1985]. Pure functions; nothing here
/// allocates, throws or keeps a state, so any thread may call it and the same input gives the same
/// bits.
///
/// Signs: position, velocity and force along one fixed direction of the base frame.

enum class FrictionPhase {
  static_contact,  ///< static friction balances the load
  critical,        ///< static, but the force is inside the band in which pushes broke it loose
  sliding,
};

[[nodiscard]] std::string_view name_of(FrictionPhase phase) noexcept;

struct FrictionParameters {
  double mass = 1.0;            ///< M [kg], > 0
  double limiting_force = 0.0;  ///< F_M [N], the mean force at which the body breaks loose, >= 0
  double limiting_force_std = 0.0;  ///< STD of F_M over the pushes [N], >= 0
  double coulomb_force = 0.0;       ///< mu M g [N], >= 0
  double viscous = 0.0;             ///< B [N s/m], >= 0
};

/// Whether all are finite and inside the ranges given above.
[[nodiscard]] bool is_physical(const FrictionParameters& parameters) noexcept;

/// Maximum static friction [N]: F_M, or the Coulomb force where that is given as the larger one (a
/// body that has just broken loose must not stop at once).
[[nodiscard]] double static_friction_limit(const FrictionParameters& parameters) noexcept;

struct SliderState {
  double position = 0.0;  ///< [m]
  double velocity = 0.0;  ///< [m/s]; exactly 0 unless sliding
  FrictionPhase phase = FrictionPhase::static_contact;
};

/// All forces but friction on the body during one step, linear from its begin to its end.
struct SliderLoad {
  double force_at_begin = 0.0;  ///< [N]
  double force_at_end = 0.0;    ///< [N]
};

struct SliderStep {
  SliderState state;         ///< at the end of the step
  double friction = 0.0;     ///< on the body at the end of the step [N]
  double dissipated = 0.0;   ///< energy that friction dissipated [J], >= 0 up to rounding
  double moving_time = 0.0;  ///< of the step [s]
};

/// Moves the body by dt [s] >= 0. Between the instants at which it breaks loose and stops, which
/// are found inside the step, M v' = F - C sgn(v) - B v is solved in closed form. So the result
/// depends on dt only as far as the load is not linear; a static body does not creep; and friction
/// is passive (adds no energy). Parameters must be physical, else the body does not move.
[[nodiscard]] SliderStep step_slider(const FrictionParameters& parameters, const SliderState& state,
                                     const SliderLoad& load, double dt) noexcept;

}  // namespace pcavr
