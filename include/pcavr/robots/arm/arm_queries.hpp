// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/physics/friction/slider.hpp"
#include "pcavr/robots/arm/driven_arm.hpp"

/// Questions about the abilities of an arm, answered by simulating it with its controller, friction
/// and limits [paper A: is it possible to catch a body, and how?]. All functions are pure, in the
/// frame of the robot's base, SI.
namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/arm/options.cpp.
struct ArmQueryOptions {
  ArmQueryOptions();
  double position_tolerance;  ///< [m]
  double max_deflection;      ///< [m]
  double hold_time;           ///< [s]
  double max_time;            ///< [s]
  double run_up;              ///< [m]
  double clearance;           ///< [m]
  DrivenArmOptions drive = {};
};
/// The options "arm.query", without those of the drive.
[[nodiscard]] OptionSection section_of(ArmQueryOptions& options);

/// The arm that a question is about, and what is around it.
struct QueriedArm {
  RobotModel model;                            ///< with masses
  std::vector<JointFit> friction;              ///< by coordinate; empty: that of the description
  std::size_t tip = 0;                         ///< link; it keeps its orientation
  Eigen::VectorXd q;                           ///< [rad] where it is now, at rest
  std::vector<TriangleMesh> link_meshes = {};  ///< by link; empty: collisions are not tested
  std::vector<TriangleMesh> obstacles = {};    ///< that only the links behind the tip may touch
};

/// The greatest torque of a motion over what its joint may have.
struct TorqueUse {
  double ratio = 0.0;     ///< above 1: the motor's limit was met
  std::size_t joint = 0;  ///< coordinate
};

struct ReachAnswer {
  bool is_possible = false;
  std::string reason = {};  ///< where it is not
  double time = 0.0;        ///< [s] that was asked for, or else the least that was found
  std::optional<double> min_time = {};  ///< [s] of the earliest possible arrival
  std::optional<double> error = {};     ///< [m] of the tip, at `time`; where a motion was simulated
  Eigen::Vector3d p_target = Eigen::Vector3d::Zero();  ///< then
  TorqueUse torque = {};
  double speed_ratio = 0.0;  ///< the greatest speed of a joint over its limit, as planned
};
/// Whether the tip is at a point at `time` [s] (else as early as it can be), along a smooth motion
/// of all joints (polynomial of fifth order, at rest at both ends). The point may move:
/// `p_target` of time, from 0 on.
[[nodiscard]] ReachAnswer can_reach(const QueriedArm& arm,
                                    const std::function<Eigen::Vector3d(double)>& p_target,
                                    std::optional<double> time,
                                    const ArmQueryOptions& options = {});

struct HoldAnswer {
  bool is_possible = false;
  std::string reason = {};
  std::optional<double> deflection = {};  ///< [m] of the tip at the end; where it reached the point
  TorqueUse torque = {};
  double max_force = 0.0;  ///< [N] in that direction, for which it is possible
};
/// Whether the tip, at rest at a point, can exert a force [N] on what it touches.
[[nodiscard]] HoldAnswer can_hold(const QueriedArm& arm, const Eigen::Vector3d& p_tip,
                                  const Eigen::Vector3d& force,
                                  const ArmQueryOptions& options = {});

/// The speed that a push of a body along a straight line needs, and whether the arm can do it.
struct PushAnswer {
  bool is_possible = false;
  std::string reason = {};
  double speed = 0.0;          ///< [m/s] at which it must leave the tip
  double sliding_time = 0.0;   ///< [s] from then until it stops
  double force = 0.0;          ///< [N] greatest, while it is pushed
  double reached_speed = 0.0;  ///< [m/s] of the simulated tip
  TorqueUse torque = {};
};
/// `distance` [m]: that the body slides after it left the tip; `p_tip`: where the tip begins to
/// push; `direction`: horizontal. The push accelerates evenly over the run-up.
[[nodiscard]] PushAnswer can_push(const QueriedArm& arm, const FrictionParameters& body,
                                  double distance, const Eigen::Vector3d& p_tip,
                                  const Eigen::Vector3d& direction,
                                  const ArmQueryOptions& options = {});

/// The speed [m/s] at which a body slides `distance` [m] until it stops, and how long that takes
/// [s], by step_slider. Throws ContractError for parameters that are not physical, or a distance
/// below 0.
struct ReleaseSpeed {
  double speed = 0.0;
  double sliding_time = 0.0;
};
[[nodiscard]] ReleaseSpeed release_speed(const FrictionParameters& body, double distance);

}  // namespace pcavr
