// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/simulation/plant_arm.hpp"

/// Ground-truth simulation of a robot tip that pushes bodies on a table. Deliberately not the model
/// that prediction uses (no inverse crime). Friction under a body is LuGre's with Stribeck
/// effect [Canudas de Wit et al. 1995] in its elasto-plastic form [Dupont et al. 2002], on many
/// patches that each carry a part of the weight; contact follows Hunt & Crossley [1975]; 20 kHz.
/// Pure functions: thread-safe and deterministic to the bit.
namespace pcavr {

/// A cuboid aligned with the axes of its body.
struct PlantCuboid {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< in the body's frame [m]
  Eigen::Vector3d half_extents;                      ///< [m]
};

/// A prism along its body's y over a convex outline: a wall that is not upright.
struct PlantPrism {
  std::vector<Eigen::Vector2d> outline_xz;  ///< in the body's x and z, counter-clockwise [m]
  double begin_y = 0.0;                     ///< [m]
  double end_y = 0.0;                       ///< [m], > begin_y
};

/// Friction and contact parameters: those of `truth/parameters.yaml`, and those of the plant's
/// LuGre model only.
struct PlantParameters {
  double mass = 1.0;                          ///< [kg], > 0
  double limiting_static_friction = 4.0;      ///< of the support under the body's weight alone [N]
  double sliding_friction_coefficient = 0.3;  ///< Coulomb friction over m g
  double viscous_friction = 10.0;             ///< [N s/m]
  double contact_stiffness = 2e4;             ///< F = stiffness d^n + damping d^n d' [N/m^n]
  double contact_damping = 6e4;               ///< [N s/m^(n+1)]
  double contact_exponent = 1.5;              ///< n, >= 1
  double tool_friction_coefficient = 0.3;     ///< between tip and body
  double stribeck_speed = 0.001;         ///< [m/s] Stribeck velocity: F_M falls to Coulomb friction
  double breakaway_displacement = 1e-5;  ///< [m] presliding displacement at breakaway
  /// The friction coefficient of a patch goes with its pressure over that under the body's weight
  /// alone to this power: -1/3 for elastic asperities, 0 for Coulomb friction [Archard 1957].
  double load_exponent = 0.0;
};

/// A patch of the contact area under a body.
struct PlantPatch {
  Eigen::Vector2d p_body;  ///< its centre, in the body's x and y [m]
  double share = 0.0;      ///< of the body's weight; the shares add up to 1
  double wear = 1.0;       ///< friction coefficient over the body's; its mean by share is 1
};

/// An upright body on a horizontal table: it moves in the plane and turns about the vertical.
struct PlantBody {
  std::string name;
  std::vector<PlantCuboid> parts;  ///< collision shape: the union of these and of the prisms
  Pose T_base_object;              ///< initial pose; rotated about z only
  bool is_movable = true;
  PlantParameters parameters;
  /// Patches of the support below the body's lowest face. Their centre of pressure is below the
  /// centre of mass, because the body stands in equilibrium.
  std::vector<PlantPatch> patches;
  std::vector<PlantPrism> prisms = {};  ///< within the bounding box of `parts`
};

/// A uniform grid of `per_side` by `per_side` patches on a rectangle about the body's origin.
[[nodiscard]] std::vector<PlantPatch> uniform_patches(const Eigen::Vector2d& half_extents,
                                                      int per_side);

/// Maximum friction moment over maximum friction force [m]: the mean distance from the centre of
/// pressure, by friction.
[[nodiscard]] double friction_radius(const std::vector<PlantPatch>& patches);

/// A position-controlled arm with a spherical tip and servo compliance: a damped spring between
/// command and tip, so that the tip deviates from the plan under load and lags behind it; or an arm
/// with its own dynamics.
struct PlantTool {
  double radius = 0.01;                                    ///< of the tip [m]
  double stiffness = 5e4;                                  ///< [N/m]
  double bandwidth = 15.0;                                 ///< [Hz] of the undamped arm
  Eigen::Vector3d p_base_start = Eigen::Vector3d::Zero();  ///< of the tip's centre [m]
  std::optional<PlantArm> arm = {};  ///< in place of the spring; its tip starts at p_base_start
};

/// A straight path of the commanded tip with a trapezoidal velocity profile; with `until_force` or
/// `until_moved` a guarded move.
struct ToolMove {
  /// `target` is in this body's frame, at its pose when the move begins. Empty: base.
  std::optional<std::size_t> body = {};
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< of the tip's centre [m]
  bool is_offset = false;  ///< `target` is relative to the current command, along the frame's axes
  double speed = 0.05;     ///< [m/s], > 0
  double acceleration = 1.0;                   ///< [m/s^2], > 0
  double modulation_amplitude = 0.0;           ///< [m] of a sine added along the path
  double modulation_frequency = 2.0;           ///< [Hz]
  std::optional<double> until_force = {};      ///< [N]: stops early when the tip presses harder
  std::optional<double> until_moved = {};      ///< [m]: stops early when `body` has moved that far
  double reaction_time = 0.0;                  ///< [s] from the stop condition to the stop
  std::optional<double> until_travelled = {};  ///< [m]: stops early after that part of the path
  bool blends_into_next = false;  ///< at the stop condition, passes its speed to the next move
  /// The arm is released instead: the tip flies freely, with its effective mass, until this long
  /// after its last contact [s]; the target is ignored. It is for impacts, as of a thrown striker:
  /// an arm's servo would drive the tip while it bounces.
  std::optional<double> release = {};
  double dwell = 0.0;  ///< [s] of rest at the end
};

enum class PlantPhase { free, static_friction, critical, sliding };

/// A change of phase as in `phase.csv`: sliding from 1 mm/s until slower than 0.3 mm/s (hysteresis;
/// rotation counts with the friction radius as lever arm), touched or not; free: at rest, not
/// touched; critical: touched, at rest, friction at 0.9 of its limit; static otherwise. A phase
/// shorter than 8 ms is merged into the previous one.
struct PlantPhaseChange {
  double t = 0.0;  ///< [s]
  std::size_t body = 0;
  PlantPhase phase = PlantPhase::free;
};

/// A contact of at most kMaxImpactDuration, from touch to separation, to the plant's own substep.
struct PlantImpact {
  double t = 0.0;  ///< [s] of the touch
  std::size_t body = 0;
  double duration = 0.0;        ///< [s]
  double approach_speed = 0.0;  ///< [m/s] along the mean force, relative to the body, > 0
  double restitution = 0.0;     ///< speed of separation over that of approach [paper B, eq. 11]
};
inline constexpr double kMaxImpactDuration = 0.1;  ///< [s]

/// One body at one instant.
struct PlantBodyState {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();  ///< of the body's origin [m]
  double yaw = 0.0;                                  ///< of its x axis from base x [rad]
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();   ///< of its centre of mass [m/s, m/s, rad/s]
  /// Friction wrench of the support on the body [N, N, N m about the centre of mass].
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();
  /// Friction coefficient of the support in translation, under the loads of this instant, over that
  /// under the body's weight alone: 1 without wear and load dependence.
  double load_factor = 1.0;
};

/// The simulated time series, in steps of kStep from t = 0.
struct PlantRun {
  static constexpr double kStep = 0.001;            ///< [s]
  std::vector<Eigen::Vector3d> p_base_tip;          ///< true centre of the tip [m]
  std::vector<Eigen::Vector3d> force_base;          ///< tool on bodies, mean over the step [N]
  std::vector<Eigen::Vector3d> torque_base;         ///< the same about the tip's centre [N m]
  std::vector<std::vector<PlantBodyState>> bodies;  ///< by body
  std::vector<PlantPhaseChange> phases;             ///< ascending in time
  std::vector<PlantImpact> impacts;                 ///< ascending in time
  std::vector<PlantArmState> arm;                   ///< empty without PlantTool::arm
  [[nodiscard]] double duration() const;            ///< [s]
};

struct PlantOptions {
  int substeps = 20;            ///< per step: 50 us each
  double tail = 0.3;            ///< [s] of rest after the last move
  double max_duration = 600.0;  ///< [s]: ends here even if moves are left
};

/// Simulates the tool's moves and the bodies. There is no contact between bodies: place them apart.
/// Throws ContractError for numbers out of range.
[[nodiscard]] PlantRun run_plant(const std::vector<PlantBody>& bodies, const PlantTool& tool,
                                 const std::vector<ToolMove>& moves,
                                 const PlantOptions& options = {});

/// The body's parameters with the friction that its slides met: the coefficient times the mean
/// load factor of all steps in which it slid, the limiting friction times that of its breakaways.
/// Those under its weight alone if it did not slide.
[[nodiscard]] PlantParameters parameters_met(const PlantRun& run, const PlantBody& body,
                                             std::size_t index);

/// The body's pose at `t` [s], interpolated; constant beyond both ends.
[[nodiscard]] Pose T_base_object_at(const PlantRun& run, const PlantBody& body, std::size_t index,
                                    double t);

/// The tip's centre in base at `t` [s], interpolated; constant beyond both ends.
[[nodiscard]] Eigen::Vector3d p_base_tip_at(const PlantRun& run, double t);

/// The arm's joints at `t` [s], likewise [rad].
[[nodiscard]] Eigen::VectorXd arm_position_at(const PlantRun& run, double t);

}  // namespace pcavr
