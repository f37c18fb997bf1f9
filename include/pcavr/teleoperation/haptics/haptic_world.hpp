// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/teleoperation/haptics/pushed_bodies.hpp"
#include "pcavr/teleoperation/haptics/rendered_force.hpp"
#include "pcavr/teleoperation/haptics/surface_proxy.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Options for pushing by the hand, and for falling bodies.
struct HapticWorldOptions {
  HapticWorldOptions();
  double scan_friction;          ///< Coulomb coefficient between tip and scan
  double max_penetration_speed;  ///< [m/s] of the tool into a body
  /// [m/s] by which the proxy is faster than the hand while it lags behind it with nothing between
  /// them: after a longer path over a rough surface or around a body.
  double catch_up_speed;
  double max_push_force;            ///< [N] of the hand on a body
  double max_push_ratio;            ///< of that force over the static limit of all bodies together
  double support_height_tolerance;  ///< [m] between a support and the lowest point of what stands
                                    ///< on it
  double max_tilt;                  ///< [rad] farther, a body slips off the edge that it tips over
  double max_fall_height;           ///< [m] after falling this far a body stops: out of view
  double acceleration_time;         ///< [s] of the tip's path from which its acceleration is found
};
[[nodiscard]] OptionSection section_of(HapticWorldOptions& options);

struct HapticWorldModel {
  WorldModel world;  ///< bodies, static scene, the tool's radius
  /// Convex outlines [m] of the support surfaces, base frame, counter-clockwise from above. A body
  /// whose centre of mass leaves all of them falls. Empty: the support is unbounded.
  std::vector<std::vector<Eigen::Vector3d>> supports_base;
  /// Virtual surfaces that only the tool meets [paper A]; may be empty.
  TriangleMesh guard_mesh_base = {};
  HapticWorldOptions options;
  ForceOptions force;  ///< of the scan; max_force and rise_time bound the whole force
};

/// The device's input, once a cycle.
struct ToolCommand {
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();  ///< [m] haptic interface point (HIP)
  bool is_engaged = false;  ///< the clutch is closed: the tool follows the tip
};

struct HapticBodyState {
  Pose T_base_object;
  Eigen::Vector3d tool_force_base = Eigen::Vector3d::Zero();  ///< [N] of the tip on the body
  MotionPhase phase = MotionPhase::free;
  bool is_outside_model = false;  ///< it left its support and falls; not predicted further
  bool is_blocked = false;        ///< pressed against the scan, or an immovable body, that holds it
  bool is_saturated = false;  ///< the hand presses on, but the force on the body is at its maximum
};

struct HapticWorldState {
  Eigen::Vector3d p_base_hip = Eigen::Vector3d::Zero();  ///< [m] of the hand
  Eigen::Vector3d p_base_proxy =
      Eigen::Vector3d::Zero();  ///< [m] the god-object's centre, outside all surfaces
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< [N] on the hand
  bool is_engaged = false;
  bool touches_scan = false;
  bool can_undo_reset = false;  ///< the last reset moved a body, and none was touched since
  std::optional<std::size_t> touched_body;
  std::vector<HapticBodyState> bodies;  ///< as in the model
};

/// Haptic rendering of a scene with movable bodies: the proxy (god-object) on scan, supports and
/// bodies, the predicted bodies, and the total force on the hand, bounded and passive (see
/// RenderedForce).
///
/// In a cycle the proxy moves no farther than the HIP and the body that it rests on do, and by
/// `catch_up_speed` more where it lags behind the HIP with nothing in between. It enters neither
/// the scan nor, unless squeezed, a body. There is no pop-through: where the HIP goes through a
/// body that cannot move, the force still acts towards the side it came from.
///
/// One thread at a time; `step` neither allocates, locks nor throws; same inputs, same bits.
class HapticWorld {
 public:
  /// Fails where no collision shape can be built from a body's mesh. Throws ContractError for
  /// numbers out of range and for outlines of fewer than three corners.
  [[nodiscard]] static Expected<HapticWorld> create(const HapticWorldModel& model);
  /// The same with bodies that are predicted elsewhere; as many as in the model: PCAVR_REQUIRE.
  [[nodiscard]] static Expected<HapticWorld> create(const HapticWorldModel& model,
                                                    std::unique_ptr<PushedBodies> bodies);
  HapticWorld(HapticWorld&&) noexcept;
  HapticWorld& operator=(HapticWorld&&) noexcept;
  ~HapticWorld();

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] const std::string& name(std::size_t body) const;

  /// Restores the initial state, with the tool at `p_base_tip` [m] or at the nearest collision-free
  /// point above it (to half its radius). Without a reset, the first valid tip places the tool.
  void reset(const Eigen::Vector3d& p_base_tip) noexcept;
  /// Puts the bodies back where they were before the last reset, at rest, with the tool as in
  /// reset(); nothing where state().can_undo_reset is false.
  void undo_reset(const Eigen::Vector3d& p_base_tip) noexcept;

  /// One cycle of `dt` [s] > 0. When not engaged, the HIP is reset to the proxy, no body is pushed,
  /// and the force decreases at its maximum rate; likewise where the tip is not finite or farther
  /// than 1 km from the origin.
  void step(const ToolCommand& command, double dt) noexcept;

  [[nodiscard]] const HapticWorldState& state() const;

 private:
  struct Content;
  explicit HapticWorld(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
