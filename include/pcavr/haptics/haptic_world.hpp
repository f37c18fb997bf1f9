// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/haptics/rendered_force.hpp"
#include "pcavr/haptics/surface_proxy.hpp"
#include "pcavr/prediction/predicted_world.hpp"

namespace pcavr {

struct HapticWorldModel {
  WorldModel world;  ///< bodies, what does not move, the tool's radius
  /// Convex outlines [m] of what the bodies stand on, base frame, counter-clockwise from above. A
  /// body whose centre of mass leaves all of them falls. Empty: the support has no edge.
  std::vector<std::vector<Eigen::Vector3d>> supports_base;
  double scan_friction = 0.2;  ///< Coulomb's, between tip and scan
  ForceOptions force;          ///< of the scan; max_force and max_rate bound the whole force
};

/// What the hand asks for, once a cycle.
struct ToolCommand {
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();  ///< [m] where the device's tip is: the HIP
  bool is_engaged = false;  ///< the clutch is held: the tool follows the tip
};

struct HapticBodyState {
  Pose T_base_object;
  Eigen::Vector3d tool_force_base = Eigen::Vector3d::Zero();  ///< [N] of the tip on the body
  MotionPhase phase = MotionPhase::free;
  bool is_outside_model = false;  ///< it left its support: it falls, and nothing more is claimed
};

struct HapticWorldState {
  Eigen::Vector3d p_base_hip = Eigen::Vector3d::Zero();  ///< [m] where the hand is
  Eigen::Vector3d p_base_proxy =
      Eigen::Vector3d::Zero();                           ///< [m] the ball's centre, outside of all
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< [N] on the hand
  bool is_engaged = false;
  bool touches_scan = false;
  int touched_body = -1;                ///< -1: none
  std::vector<HapticBodyState> bodies;  ///< as in the model
};

/// A room to push in: the proxy on scan, supports and bodies, the predicted bodies, and one force
/// from all of it on the hand, bounded and passive (see RenderedForce).
///
/// In a cycle the proxy moves no farther than the HIP and the body that it rests on do, and by 0.5
/// m/s more where it lags behind the HIP with nothing in between. It enters neither the scan nor,
/// unless squeezed, a body; a hand that goes through a body that cannot move stays felt on the side
/// it came from.
///
/// One thread at a time; `step` neither allocates, locks nor throws; same inputs, same bits.
class HapticWorld {
 public:
  /// Fails where a body cannot be made a collision shape. Throws ContractError for numbers out of
  /// their range, and for outlines of fewer than three corners.
  [[nodiscard]] static Expected<HapticWorld> create(const HapticWorldModel& model);
  HapticWorld(HapticWorld&&) noexcept;
  HapticWorld& operator=(HapticWorld&&) noexcept;
  ~HapticWorld();

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] const std::string& name(std::size_t body) const;

  /// Everything back to where it was at the start; the tool where `p_base_tip` [m] is, or as near
  /// above it as there is room (to half its radius). Without it, the first tip that is told places
  /// the tool.
  void reset(const Eigen::Vector3d& p_base_tip) noexcept;

  /// One cycle of `dt` [s] > 0. Let go, the HIP goes back to the proxy, pushes nothing, and the
  /// force fades at its rate. So it is where the tip is not finite, or farther than 1 km off.
  void step(const ToolCommand& command, double dt) noexcept;

  [[nodiscard]] const HapticWorldState& state() const;

 private:
  struct Content;
  explicit HapticWorld(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
