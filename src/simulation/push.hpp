// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"

#include "simulation/world.hpp"

namespace pcavr::simulation {

/// What resists a push, as `truth/parameters.yaml` names it.
struct PushParameters {
  double mass = 0.0;                          ///< [kg]
  double limiting_static_friction = 0.0;      ///< [N]
  double sliding_friction_coefficient = 0.0;  ///< Coulomb part over m g
  double viscous_friction = 0.0;              ///< [N s/m]
  double contact_stiffness = 0.0;             ///< F = stiffness d^exponent + damping d^exponent d'
  double contact_damping = 0.0;
  double contact_exponent = 1.5;  ///< a ball against a face [Hertz 1882]
};

enum class PushPhase { free, static_friction, critical, sliding };

struct PhaseChange {
  double t = 0.0;  ///< [s]
  std::size_t box = 0;
  PushPhase phase = PushPhase::free;
};

/// What happened, in steps of kStep from t = 0 on.
struct PushRun {
  static constexpr double kStep = 0.001;  ///< [s]
  std::vector<Eigen::Vector3d> tip;       ///< centre of the tool's tip in base [m]
  std::vector<std::vector<double>> slid;  ///< by box: its way along base y [m]
  std::vector<double> force;  ///< tool on boxes along y, mean over the step that begins here [N]
  std::vector<PhaseChange> phases;         ///< ascending in time
  std::vector<PushParameters> parameters;  ///< by box
};

/// A small model of pushing, not a simulation of the whole plant: the tool follows its planned way
/// whatever it meets; each box has one degree of freedom, along base y through its centre, so that
/// it neither turns nor tips. Contact is Hunt & Crossley's [1975]; friction sticks up to its
/// limit, then is Coulomb's plus a viscous part. `duration` [s] is shared evenly by the boxes.
[[nodiscard]] PushRun simulate_push(const World& world, double duration, std::uint64_t seed);

/// Poses of all of the world's bodies at `t` [s]. Without a tool, all rests where it starts.
[[nodiscard]] std::vector<Pose> body_poses(const World& world, const PushRun& run, double t);

}  // namespace pcavr::simulation
