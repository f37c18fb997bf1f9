// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"

/// A robot's tip that pushes bodies over a table: the stand-in for the real world, and on purpose
/// not the model that prediction computes with. Friction under a body is LuGre's with Stribeck
/// effect [Canudas de Wit et al. 1995] in its elasto-plastic form [Dupont et al. 2002], on many
/// patches that each bear a part of the weight; contact is Hunt & Crossley's [1975]; 20 kHz.
/// Plain functions of their arguments: any thread may call them, same input gives the same bits.
namespace pcavr {

/// A cuboid with axes along its body's.
struct PlantCuboid {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< in the body's frame [m]
  Eigen::Vector3d half_extents;                      ///< [m]
};

/// What resists and yields, as `truth/parameters.yaml` names it, and what only the plant knows.
struct PlantParameters {
  double mass = 1.0;                          ///< [kg], > 0
  double limiting_static_friction = 4.0;      ///< of the support under the body's weight alone [N]
  double sliding_friction_coefficient = 0.3;  ///< Coulomb part over m g
  double viscous_friction = 10.0;             ///< [N s/m]
  double contact_stiffness = 2e4;             ///< F = stiffness d^n + damping d^n d' [N/m^n]
  double contact_damping = 6e4;               ///< [N s/m^(n+1)]
  double contact_exponent = 1.5;              ///< n, >= 1
  double tool_friction_coefficient = 0.3;     ///< between tip and body
  double stribeck_speed = 0.001;              ///< [m/s] over which F_M falls to Coulomb's part
  double bristle_reach = 1e-5;                ///< [m] that the body gives before it breaks away
};

/// A part of the support under a body.
struct PlantPatch {
  Eigen::Vector2d p_body;  ///< its middle, in the body's x and y [m]
  double share = 0.0;      ///< of the body's weight; the shares add up to 1
};

/// An upright body on a horizontal table: it moves in the plane and turns about the vertical.
struct PlantBody {
  std::string name;
  std::vector<PlantCuboid> parts;  ///< what the tip touches: their union
  Pose T_base_object;              ///< where it starts; turned about z only
  bool is_movable = true;
  PlantParameters parameters;
  /// Below the body's lowest face. Their centre is where the centre of mass has to be, because the
  /// body stands.
  std::vector<PlantPatch> patches;
};

/// Even patches of a rectangle about the body's origin: `along` by `along` of them.
[[nodiscard]] std::vector<PlantPatch> even_patches(const Eigen::Vector2d& half_extents, int along);

/// The moment that the patches bear over the force [m]: the mean distance from their centre.
[[nodiscard]] double friction_radius(const std::vector<PlantPatch>& patches);

/// A position-controlled arm with a ball at its tip. It gives way like a damped spring and follows
/// its command with a lag, so that the tip is not where the plan has it.
struct PlantTool {
  double radius = 0.01;                                    ///< of the tip [m]
  double stiffness = 5e4;                                  ///< [N/m]
  double bandwidth = 15.0;                                 ///< [Hz] of the undamped arm
  Eigen::Vector3d p_base_start = Eigen::Vector3d::Zero();  ///< of the tip's centre [m]
};

/// A straight way of the commanded tip, with a trapezoid of speed.
struct ToolMove {
  /// Whose frame `target` is in, as the body stands when the move begins. Empty: base.
  std::optional<std::size_t> body = {};
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< of the tip's centre [m]
  bool is_offset = false;        ///< `target` is from where the command is, along the frame's axes
  double speed = 0.05;           ///< [m/s], > 0
  double acceleration = 1.0;     ///< [m/s^2], > 0
  double swing = 0.0;            ///< [m] to and fro along the way, on top of it
  double swing_frequency = 2.0;  ///< [Hz]
  std::optional<double> until_force = {};  ///< [N]: stops early when the tip presses harder
  std::optional<double> until_moved = {};  ///< [m]: stops early when `body` has moved that far
  double reaction = 0.0;                   ///< [s] from what stops it early until it does stop
  bool flows_on = false;  ///< stopped early, it hands its speed to the next move instead
  double dwell = 0.0;     ///< [s] at rest afterwards
};

enum class PlantPhase { free, static_friction, critical, sliding };

/// As `phase.csv` has it: sliding from 1 mm/s until slower than 0.3 mm/s (a turn counts with the
/// friction radius as its arm), touched or not; free: at rest, not touched; critical: touched, at
/// rest, friction at 0.9 of its limit; static otherwise. Less than 8 ms joins what was before.
struct PlantPhaseChange {
  double t = 0.0;  ///< [s]
  std::size_t body = 0;
  PlantPhase phase = PlantPhase::free;
};

/// One body at one instant.
struct PlantBodyState {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();  ///< of the body's origin [m]
  double yaw = 0.0;                                  ///< of its x axis from base x [rad]
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();   ///< of its centre of mass [m/s, m/s, rad/s]
  /// Of the support on the body [N, N, N m about the centre of mass].
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();
};

/// What happened, in steps of kStep from t = 0 on.
struct PlantRun {
  static constexpr double kStep = 0.001;            ///< [s]
  std::vector<Eigen::Vector3d> p_base_tip;          ///< true centre of the tip [m]
  std::vector<Eigen::Vector3d> force_base;          ///< tool on bodies, mean over the step [N]
  std::vector<Eigen::Vector3d> torque_base;         ///< the same about the tip's centre [N m]
  std::vector<std::vector<PlantBodyState>> bodies;  ///< by body
  std::vector<PlantPhaseChange> phases;             ///< ascending in time
  [[nodiscard]] double duration() const;            ///< [s]
};

struct PlantOptions {
  int substeps = 20;            ///< in a step: 50 us each
  double tail = 0.3;            ///< [s] at rest after the last move
  double max_duration = 600.0;  ///< [s]: where it ends, whatever is left to do
};

/// Lets the tool make its moves among the bodies. Bodies do not touch each other: keep them apart.
/// Throws ContractError for numbers out of their range.
[[nodiscard]] PlantRun run_plant(const std::vector<PlantBody>& bodies, const PlantTool& tool,
                                 const std::vector<ToolMove>& moves,
                                 const PlantOptions& options = {});

/// The body's pose at `t` [s], interpolated; held at both ends.
[[nodiscard]] Pose T_base_object_at(const PlantRun& run, const PlantBody& body, std::size_t index,
                                    double t);

/// The tip's centre in base at `t` [s], interpolated; held at both ends.
[[nodiscard]] Eigen::Vector3d p_base_tip_at(const PlantRun& run, double t);

}  // namespace pcavr
