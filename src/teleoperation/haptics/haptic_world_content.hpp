// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/teleoperation/haptics/haptic_world.hpp"

#include "teleoperation/haptics/body_shape.hpp"
#include "teleoperation/haptics/falling_body.hpp"
#include "teleoperation/haptics/floor_heights.hpp"
#include "teleoperation/haptics/proxy_sphere.hpp"
#include "teleoperation/haptics/supports.hpp"
#include "teleoperation/haptics/tip_acceleration.hpp"

namespace pcavr {

/// The state of a haptic world and a cycle's steps: the tip (haptic_world_tip.cpp), the bodies
/// (haptic_world_bodies.cpp), the force (haptic_world.cpp); and resets (haptic_world_reset.cpp).
struct HapticWorld::Content {
  struct Body {
    explicit Body(detail::BodyShape body_shape) : shape(std::move(body_shape)) {}

    detail::BodyShape shape;
    double max_penetration = 0.0;  ///< [m] of the tool
    double contact_mass = 0.0;     ///< [kg] see BodyPhysics
    bool has_support = false;      ///< initially
    bool is_under_tool = false;    ///< the proxy is in contact with it
    bool is_saturated = false;     ///< the tip is as deep in it as it may be, the hand deeper
    Pose T_base_object;            ///< after the latest step
    std::optional<detail::FallingBody> fall;
    std::optional<detail::FallingBody> fall_before_reset;
  };

  /// The proxy's surfaces: the scan, the supports, the guards, and then the bodies.
  static constexpr std::size_t kFirstBody = 3;

  Content(const HapticWorldModel& model, std::unique_ptr<PushedBodies> pushed);

  void reset(const Eigen::Vector3d& tip) noexcept;
  void undo_reset(const Eigen::Vector3d& tip) noexcept;
  void step(const ToolCommand& command, double dt) noexcept;

 private:
  /// Finite, and not absurdly far away.
  [[nodiscard]] static bool is_valid_tip(const Eigen::Vector3d& p) noexcept;
  void set_bodies(const std::vector<BodyState>& bodies_at) noexcept;
  [[nodiscard]] bool have_moved() const noexcept;
  void place_tip(const Eigen::Vector3d& wanted_tip) noexcept;
  [[nodiscard]] bool is_collision_free(const Eigen::Vector3d& centre) const noexcept;
  [[nodiscard]] bool is_near(const Body& body, const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] std::optional<detail::ClosestSurface::Result> closest(const Body& body,
                                                                      const Eigen::Vector3d& p,
                                                                      double reach) const noexcept;
  [[nodiscard]] auto closest(const Body& body, const Eigen::Vector3d& p) const noexcept {
    return closest(body, p, proxy.radius());
  }
  [[nodiscard]] bool is_resting_on_body() const noexcept;
  [[nodiscard]] bool may_catch_up() const noexcept;
  void follow(double displacement, double dt) noexcept;
  void update_tip(double dt) noexcept;
  [[nodiscard]] Eigen::Vector3d limited_penetration(const Eigen::Vector3d& direction,
                                                    double desired,
                                                    double max_change) const noexcept;
  [[nodiscard]] bool is_through_contact_face(const Eigen::Vector3d& p) const noexcept;
  void release() noexcept;
  void move_bodies(double dt) noexcept;
  void start_falling(std::size_t i) noexcept;
  void resolve_overlap() noexcept;
  void compute_force(const Eigen::Vector3d& device, double dt) noexcept;
  void publish_bodies() noexcept;

 public:
  std::unique_ptr<PushedBodies> world;
  std::vector<BodyState> start;
  std::vector<BodyState> before_reset;
  std::vector<BodyState> work;  ///< buffer, so that removing a body does not allocate
  detail::Supports supports;
  detail::FloorHeights floor;  ///< what the scan shows below the supports
  detail::ProxySphere proxy;
  RenderedForce force;
  detail::TipAcceleration acceleration;
  double gravity;
  double max_tip_speed;
  HapticWorldOptions options;
  double min_force;
  double top = 0.0;  ///< [m] above everything
  std::vector<Body> bodies;
  HapticWorldState state;

  bool is_placed = false;
  double body_displacement = 0.0;  ///< [m] of the bodies under the tool in the latest step
  Eigen::Vector3d penetration =
      Eigen::Vector3d::Zero();  ///< [m] from the proxy to the prediction's tip
  Eigen::Vector3d scan_normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d hip = Eigen::Vector3d::Zero();
  Eigen::Vector3d goal = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> tip;         ///< [m] of the prediction; empty while disengaged
  std::optional<Eigen::Vector3d> tip_before;  ///< a step earlier
  Eigen::Vector3d static_proxy =
      Eigen::Vector3d::Zero();  ///< [m] the proxy's centre among static surfaces only
};

}  // namespace pcavr
