// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// Mass, centre of mass and rotational inertia of a rigid body, in the axes of a frame that the
/// field or variable names.
struct RigidInertia {
  double mass = 0.0;                                         ///< [kg]
  Eigen::Vector3d centre_of_mass = Eigen::Vector3d::Zero();  ///< in the frame [m]
  Eigen::Matrix3d inertia_at_com = Eigen::Matrix3d::Zero();  ///< about the centre of mass [kg m^2]
};

/// The inertia of the same body in frame a, from that in frame b.
[[nodiscard]] RigidInertia transform(const Pose& T_a_b, const RigidInertia& inertia_b);

/// The inertia of two bodies joined rigidly, both in the same frame.
[[nodiscard]] RigidInertia operator+(const RigidInertia& a, const RigidInertia& b);

/// Why no rigid body can have this inertia (mass not positive, inertia not positive definite,
/// triangle inequality of its principal moments violated by more than 1e-6 of the largest); nothing
/// if one can. Point masses and rods (principal moments of zero) are possible.
[[nodiscard]] std::optional<std::string> physical_fault(const RigidInertia& inertia);

struct BoxShape {
  Eigen::Vector3d size;  ///< full edge lengths [m], > 0
};
/// A cylinder about z, centred.
struct CylinderShape {
  double radius;  ///< [m], > 0
  double length;  ///< [m], > 0
};
struct SphereShape {
  double radius;  ///< [m], > 0
};
struct MeshShape {
  std::filesystem::path file;  ///< resolved; empty if no such file was found
  std::string reference;       ///< as written: package://..., file://... or a path
  Eigen::Vector3d scale;       ///< by axis, without unit
};

/// A visible or colliding part of a link.
struct RobotShape {
  std::string name;  ///< may be empty
  Pose T_link_shape;
  std::variant<BoxShape, CylinderShape, SphereShape, MeshShape> geometry;
  std::optional<std::array<double, 4>> color;  ///< red, green, blue, alpha in [0, 1]
};

/// A link of the description. Links behind fixed joints move with the same movable joint.
struct RobotLink {
  std::string name;
  std::optional<std::size_t> joint;  ///< the movable joint that carries it; none: fixed to the base
  Pose T_joint_link;  ///< in that joint's moving frame, or in the base frame; constant
  std::optional<RigidInertia> inertia;  ///< in the link's frame
  std::vector<RobotShape> visuals;
  std::vector<RobotShape> collisions;
};

enum class JointKind { kRevolute, kContinuous, kPrismatic };

/// Units by kind: rad, rad/s, N m or m, m/s, N.
struct JointLimits {
  std::optional<double> lower;     ///< none for continuous joints
  std::optional<double> upper;     ///< none for continuous joints
  std::optional<double> velocity;  ///< > 0; none where the description says 0
  std::optional<double> effort;    ///< > 0; none where the description says 0
};

/// A movable joint, with everything that moves rigidly with it ("its body"). The joint frame is the
/// frame of its child link; at position 0 it is at T_parent_joint, and it turns about (or slides
/// along) `axis`.
struct RobotJoint {
  std::string name;
  std::string child_link;
  JointKind kind = JointKind::kRevolute;
  std::optional<std::size_t> parent;  ///< joint whose body carries it, an earlier one; none: base
  Pose T_parent_joint;  ///< at position 0, in the joint frame of `parent` or in the base frame
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit, in the joint frame
  JointLimits limits;

  /// Index in the vectors q, dq, ddq, tau. The joint's position is multiplier * q + offset, with
  /// 1 and 0 except for joints that mimic another: those share its coordinate.
  std::size_t coordinate = 0;
  bool mimics = false;  ///< whether it follows another joint, which has the same coordinate
  double multiplier = 1.0;
  double offset = 0.0;  ///< [rad] or [m]

  /// Inertia of the child link and all links fixed to it, in the joint frame. Mass 0 where no link
  /// has one.
  RigidInertia body;
  /// Inertia of the motor [kg m^2] or [kg], seen from the joint: rotor inertia times the gear ratio
  /// squared. Adds armature * ddq to the torque. Read from the URDF's `<transmission>`, else 0.
  double armature = 0.0;
  double damping = 0.0;   ///< URDF `damping` [N m s/rad]; not part of the dynamics here
  double friction = 0.0;  ///< URDF `friction` [N m]: Coulomb; not part of the dynamics here
};

/// A tree of rigid bodies on a fixed base. The base frame is that of the root link. A plain value:
/// copies are independent; const access is thread-safe.
struct RobotModel {
  std::string name;
  std::filesystem::path file;      ///< where it was read from, may be empty
  std::vector<RobotLink> links;    ///< parents before children, the root link first
  std::vector<RobotJoint> joints;  ///< movable ones, parents before children
  std::size_t dof = 0;             ///< number of coordinates: joints that mimic no other
  Eigen::Vector3d gravity_base{0.0, 0.0, -kStandardGravity};  ///< [m/s^2]
  /// Doubts about the description that do not prevent its use, in its order.
  std::vector<Error> warnings;

  [[nodiscard]] std::optional<std::size_t> joint_index(std::string_view joint_name) const;
  [[nodiscard]] std::optional<std::size_t> link_index(std::string_view link_name) const;
  /// The joint that defines each coordinate.
  [[nodiscard]] std::vector<std::size_t> coordinate_joints() const;
  [[nodiscard]] bool has_mimic_joints() const { return dof != joints.size(); }
  /// Whether each joint's body, or one that it carries further on, has a mass: what dynamics need.
  [[nodiscard]] bool has_inertia() const;
};

/// The model with some joints locked at a position ([rad] or [m], by name), for instance a gripper:
/// their bodies become fixed to the ones that carry them. Joints that mimic a locked one are locked
/// with it. Throws ContractError for an unknown name and for a joint that mimics another.
struct LockedJoint {
  std::string name;
  double position = 0.0;
};
[[nodiscard]] RobotModel lock_joints(const RobotModel& model,
                                     const std::vector<LockedJoint>& locked);

/// Ten numbers a movable joint: [m, m cx, m cy, m cz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz] of its body,
/// the inertia about the origin of the joint frame, in its axes [Atkeson, An & Hollerbach 1986].
/// The torque is linear in them: see RobotDynamics::regressor.
[[nodiscard]] Eigen::VectorXd inertial_parameters(const RobotModel& model);

/// The model whose bodies have these inertial parameters, 10 * joints numbers. They need not be
/// physically possible (see physical_fault); a mass of 0 with a first moment of 0 is allowed, with
/// another first moment not: throws ContractError, as for a wrong size or numbers not finite. The
/// links' own inertias are not changed: only the bodies count in the dynamics.
[[nodiscard]] RobotModel with_inertial_parameters(const RobotModel& model,
                                                  const Eigen::VectorXd& parameters);

}  // namespace pcavr
