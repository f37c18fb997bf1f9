// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/friction/planar_slider.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// The motion phase of an object; name_of gives the words of `phase.csv`.
enum class MotionPhase {
  free,            ///< at rest, not touched
  static_contact,  ///< touched and at rest: "static"
  critical,        ///< touched, at rest, and close to the static friction limit
  sliding,
};
[[nodiscard]] std::string_view name_of(MotionPhase phase) noexcept;

/// A body that stays upright on its support: it slides and rotates on the plane. An immovable one
/// keeps its pose under any force; of its physics only contact and tool friction are used.
struct WorldBody {
  CadModel model;
  Pose T_base_object;  ///< its initial pose
  BodyPhysics physics;
  bool is_movable = true;
};

/// Limits of the robot's tool, contact between bodies and with the scan, and collision shapes.
struct WorldOptions {
  WorldOptions();
  double max_tip_speed;         ///< [m/s] a faster tip has jumped
  double max_contact_force;     ///< [N] between tip and body
  double body_friction;         ///< coefficient between bodies, which is not identified
  double body_penetration;      ///< [m] of two bodies under the force at which one breaks loose
  double max_separation_speed;  ///< [m/s] at which an overlap of two bodies is resolved
  double min_obstacle_height;   ///< [m] lower surfaces are the support and its noise
  double max_scan_penetration;  ///< [m] of a body into the scan, under any force
  double max_scan_depth;        ///< [m] a scanned surface deeper inside a body does not touch it
  double shape_tolerance;       ///< of a body's diagonal: depth of a concavity that stays filled
  int max_convex_parts;         ///< of a body's collision shape
};
[[nodiscard]] OptionSection section_of(WorldOptions& options);

struct WorldModel {
  std::vector<WorldBody> bodies;
  TriangleMesh static_mesh_base;      ///< may be empty
  double tool_radius = 0.01;          ///< of the spherical tip [m], > 0
  double gravity = kStandardGravity;  ///< [m/s^2]
  WorldOptions options = {};
};

/// The tip's hold on one of several faces that it touches at once, in base axes.
struct TipGrip {
  Eigen::Vector3d normal_base = Eigen::Vector3d::Zero();                 ///< out of the body
  Eigen::Vector3d tangential_deflection_base = Eigen::Vector3d::Zero();  ///< as BodyState's [m]
};

/// The state of one body at one instant. A plain value: history is kept as copies of it.
struct BodyState {
  PlanarState planar;  ///< of the centre of mass in base; yaw is relative to the initial pose
  /// Tangential deflection of the surface by the tip before it slips [m], base axes (bristle
  /// model): of the deepest contact.
  Eigen::Vector3d tangential_deflection_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d tool_force_base = Eigen::Vector3d::Zero();  ///< of the tip on the body [N]
  double penetration = 0.0;  ///< of the tip, > 0 in contact; negative: clearance up to 50 mm [m]
  /// Outward normal of the face that the tip presses on, or is closest to, in base axes at yaw 0;
  /// zero: not known. Deep in a soft body near a corner, the tip gets closer to another face.
  Eigen::Vector3d entry_normal = Eigen::Vector3d::Zero();
  static constexpr int kMaxGrips = 3;  ///< as in a hole's corner: two walls and the floor
  std::array<TipGrip, kMaxGrips> grips = {};
  int grip_count = 0;  ///< 0 where the tip touches one face at most
  MotionPhase phase = MotionPhase::free;
  /// The tip pushes with more than the static friction limit, or would, but the scan or an
  /// immovable body is in the way.
  bool is_blocked = false;
  /// The tip's force is at `max_contact_force`: it does not grow as the tip goes on.
  bool is_saturated = false;
  bool is_present = true;  ///< false: taken out of the world, it neither moves nor touches anything
};

/// Bodies, a static environment, and a tool that pushes: contact by the identified law,
/// support friction by our three phases, collision detection by Bullet. Deterministic: same inputs,
/// same bits, also after rollback and re-simulation. One thread at a time.
class PredictedWorld {
 public:
  /// Fails where no collision shape can be built for a body. Throws ContractError for numbers out
  /// of their range.
  [[nodiscard]] static Expected<PredictedWorld> create(WorldModel model);
  PredictedWorld(PredictedWorld&&) noexcept;
  PredictedWorld& operator=(PredictedWorld&&) noexcept;
  ~PredictedWorld();

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] const std::string& name(std::size_t body) const;
  [[nodiscard]] const BodyPhysics& physics(std::size_t body) const;
  void set_physics(std::size_t body, const BodyPhysics& physics);

  [[nodiscard]] const std::vector<BodyState>& state() const;
  /// `state.size() == size()`. Does not allocate.
  void set_state(const std::vector<BodyState>& state);
  /// Places a body at rest. Only the planar part is used: height and tilt stay as at the start.
  void set_pose(std::size_t body, const Pose& T_base_object);
  [[nodiscard]] Pose T_base_object(std::size_t body) const;
  /// The same of any state of that body.
  [[nodiscard]] Pose pose_of(std::size_t body, const BodyState& state) const;

  /// Advances the world by dt [s] > 0 while the tip's centre goes in a straight line from
  /// `p_base_before` to `p_base_tip`. Neither allocates nor throws.
  void step(const Eigen::Vector3d& p_base_before, const Eigen::Vector3d& p_base_tip,
            double dt) noexcept;
  /// The same without a tool.
  void step(double dt) noexcept;

 private:
  struct Content;
  explicit PredictedWorld(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
