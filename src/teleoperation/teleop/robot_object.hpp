// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "teleoperation/teleop/object_corrections.hpp"
#include "teleoperation/teleop/object_knowledge.hpp"
#include "teleoperation/teleop/object_pose.hpp"

namespace pcavr {

/// The robot site's state of one object: where it is, what is known of it, and what the operator's
/// site has of both. Not thread-safe.
class RobotObject {
 public:
  /// Keeps a reference to `object`, which must outlive it; its `tracked` is not used. `assumed`:
  /// the physics that the operator's site has at the start.
  RobotObject(const TeleopObject& object, const BodyPhysics& assumed, const TeleopOptions& options,
              const SensorProperties& sensors, double tool_radius, double start);

  [[nodiscard]] ObjectPose& pose() { return pose_; }
  [[nodiscard]] const ObjectPose& pose() const { return pose_; }
  [[nodiscard]] PhaseMonitor& monitor() { return pose_.monitor(); }
  [[nodiscard]] const PhaseMonitor& monitor() const { return pose_.monitor(); }
  [[nodiscard]] ObjectKnowledge& knowledge() { return knowledge_; }
  [[nodiscard]] const ObjectKnowledge& knowledge() const { return knowledge_; }
  [[nodiscard]] ObjectCorrections& corrections() { return corrections_; }
  [[nodiscard]] const ObjectCorrections& corrections() const { return corrections_; }
  [[nodiscard]] const std::string& name() const { return pose_.source().name; }

  /// Discards what was identified here: the data were wrong.
  void forget_learned();
  /// Another object moved with it: the force of this contact does not act on this one alone.
  void set_shared(bool is_shared) { is_shared_ = is_shared; }
  [[nodiscard]] bool is_shared() const { return is_shared_; }
  /// See ObjectPose::estimate.
  [[nodiscard]] PoseEstimate estimate_pose(const TouchSample& sample, const PlanarPose& predicted) {
    return pose_.estimate(sample, predicted, knowledge_.parameters());
  }

  /// The physics that the operator's site has with these parameters.
  [[nodiscard]] BodyPhysics physics_with(const ObjectParameters& parameters) const;
  /// The physics used at this site: identified parameters, completed by defaults.
  [[nodiscard]] BodyPhysics physics() const;
  /// The same as parameters that the operator's site is to have.
  [[nodiscard]] ObjectParameters parameters() const;

 private:
  double gravity_;  ///< [m/s^2]
  /// Its Stribeck speed is that of the given parameters: what both sites know later are complete
  /// sets of values, assumed ones among them.
  PhysicsDefaults unknown_objects_;
  /// The surface as completed at the start: its shape stays constant, and is expensive to compute.
  std::optional<LimitSurface> limit_surface_;
  bool is_shared_ = false;
  ObjectPose pose_;
  ObjectCorrections corrections_;
  ObjectKnowledge knowledge_;
};

}  // namespace pcavr
