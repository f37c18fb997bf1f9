// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include <Eigen/Core>

namespace pcavr {

/// The damping of a Hunt-Crossley contact for a coefficient of restitution c: seven published
/// models and the exact one. Each is lambda = g(c) k / v, with v the approach speed just before
/// impact.
enum class DampingLaw {
  flores,
  gonthier,
  lankarani_nikravesh,
  lee_wang,
  hunt_crossley,
  zhiying_qishao,
  herbert_mcwhannell,
  exact,  ///< the solution of the impact itself; see exact_damping_factor
};

/// The seven of paper B, in its order, without the exact one.
inline constexpr std::array kPublishedDampingLaws{DampingLaw::flores,
                                                  DampingLaw::gonthier,
                                                  DampingLaw::lankarani_nikravesh,
                                                  DampingLaw::lee_wang,
                                                  DampingLaw::hunt_crossley,
                                                  DampingLaw::zhiying_qishao,
                                                  DampingLaw::herbert_mcwhannell};

[[nodiscard]] std::string_view name_of(DampingLaw law) noexcept;

/// The law's name in options and parameter files: "herbert_mcwhannell".
[[nodiscard]] std::string_view key_of(DampingLaw law) noexcept;
[[nodiscard]] std::optional<DampingLaw> damping_law_of(std::string_view key) noexcept;

/// g(c), dimensionless. c in (0, 1]; infinity at 0 and below, where no finite damping exists.
[[nodiscard]] double damping_factor(DampingLaw law, double restitution) noexcept;

/// The g that gives exactly this restitution: the root chi > 0 of
///   chi (1 + c) = ln((1 + chi) / (1 - chi c)),
/// the integral of a Hunt-Crossley impact; it holds for every exponent, stiffness, mass and speed.
/// Accurate to a few rounding errors over (0, 1]; infinity at 0 and below.
[[nodiscard]] double exact_damping_factor(double restitution) noexcept;

/// lambda [N s/m^(n+1)] of a contact of `stiffness` [N/m^n] met at `approach_speed` [m/s] > 0.
[[nodiscard]] double hunt_crossley_damping(DampingLaw law, double stiffness, double restitution,
                                           double approach_speed) noexcept;

/// Measured velocities of one impact, all in one frame [m/s]; the tool is paper B's "end".
struct ImpactVelocities {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< from the tool into the body; any length
  Eigen::Vector3d tool_before = Eigen::Vector3d::Zero();
  Eigen::Vector3d body_before = Eigen::Vector3d::Zero();
  Eigen::Vector3d tool_after = Eigen::Vector3d::Zero();
  Eigen::Vector3d body_after = Eigen::Vector3d::Zero();
};

/// The coefficient of restitution [paper B, eq. 11]. Empty where the two did not approach, or a
/// value is not finite. Noise may put it outside of [0, 1]: the caller has to check.
[[nodiscard]] std::optional<double> measured_restitution(
    const ImpactVelocities& velocities) noexcept;

}  // namespace pcavr
