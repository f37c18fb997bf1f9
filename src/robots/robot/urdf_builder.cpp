// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot/urdf_builder.hpp"

#include <cmath>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "robots/robot/mesh_reference.hpp"

namespace pcavr::robot {
namespace {

Eigen::Vector3d vector_of(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Pose pose_of(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {Eigen::Quaterniond(q.w, q.x, q.y, q.z), vector_of(pose.position)};
}

/// Beyond these, products overflow; no robot comes near.
constexpr double kMaxLength = 1e4;    // [m]
constexpr double kMaxMass = 1e6;      // [kg]
constexpr double kMaxInertia = 1e9;   // [kg m^2]
constexpr double kMaxRatio = 1e6;     // of a mimic joint
constexpr double kMaxFriction = 1e6;  // [N m s/rad, N m] or [N s/m, N]: stops any arm

bool is_plausible(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  const Eigen::Vector3d position = vector_of(pose.position);
  // The largest of some numbers may ignore one that is not finite.
  return position.allFinite() && position.cwiseAbs().maxCoeff() < kMaxLength &&
         std::isfinite(q.x + q.y + q.z + q.w);
}

/// Walks along the tree and fills the model; each step returns its fault.
class RobotBuilder {
 public:
  RobotBuilder(const urdf::ModelInterface& description, const UrdfStructure& structure,
               const std::filesystem::path& file, const UrdfOptions& options)
      : description_(description), structure_(structure), file_(file), options_(options) {}

  Expected<RobotModel> build() {
    model_.name = structure_.robot_name;
    model_.file = file_;
    for (const UrdfStructure::Step& step : structure_.order) {
      if (auto fault = add_link(step)) return *fault;
    }
    if (auto fault = connect_mimics()) return *fault;
    merge_inertias();
    return std::move(model_);
  }

 private:
  using Fault = std::optional<Error>;

  [[nodiscard]] Error finding(const UrdfElement& element, const char* kind, std::string message,
                              std::string hint) const {
    return {std::move(message), file_.string(), element.line,
            fmt::format("{} '{}'", kind, element.name), std::move(hint)};
  }

  Fault add_link(const UrdfStructure::Step& step) {
    const UrdfElement& element = structure_.links[step.link];
    const urdf::LinkConstSharedPtr source = description_.getLink(element.name);
    if (!source) {
      return finding(element, "link", "was not understood", "check its elements and attributes");
    }
    RobotLink link;
    link.name = element.name;
    if (step.joint) {
      if (auto fault = place_link(structure_.joints[*step.joint], link)) return fault;
    }
    if (auto fault = read_inertia(element, *source, link)) return fault;
    for (std::size_t i = 0; i < source->visual_array.size(); ++i) {
      const urdf::VisualSharedPtr& visual = source->visual_array[i];
      const std::size_t shapes = link.visuals.size();
      if (auto fault = add_shape({element, "visual", i}, visual.get(), link.visuals)) return fault;
      if (link.visuals.size() > shapes && visual->material) {
        const urdf::Color& c = visual->material->color;
        link.visuals.back().color = {{c.r, c.g, c.b, c.a}};
      }
    }
    for (std::size_t i = 0; i < source->collision_array.size(); ++i) {
      const urdf::Collision* collision = source->collision_array[i].get();
      if (auto fault = add_shape({element, "collision", i}, collision, link.collisions)) {
        return fault;
      }
    }
    model_.links.push_back(std::move(link));
    return std::nullopt;
  }

  /// Sets the link's joint and place in its frame; a movable joint is added to the model.
  Fault place_link(const UrdfJointElement& element, RobotLink& link) {
    const urdf::JointConstSharedPtr source = description_.getJoint(element.name);
    if (!source) {
      return finding(element, "joint", "was not understood", "check its elements and attributes");
    }
    if (!is_plausible(source->parent_to_joint_origin_transform)) {
      return finding(element, "joint", fmt::format("origin is {:g} m away or more", kMaxLength),
                     "correct its <origin>; lengths are in metres");
    }
    const RobotLink& parent =
        model_.links[model_.link_index(structure_.links[element.parent].name).value()];
    const Pose T_parent_joint =
        parent.T_joint_link * pose_of(source->parent_to_joint_origin_transform);
    if (element.type == "fixed") {
      link.joint = parent.joint;
      link.T_joint_link = T_parent_joint;
      return std::nullopt;
    }
    link.joint = model_.joints.size();
    RobotJoint joint;
    joint.name = element.name;
    joint.child_link = link.name;
    joint.parent = parent.joint;
    joint.T_parent_joint = T_parent_joint;
    joint.kind = element.type == "revolute"     ? JointKind::kRevolute
                 : element.type == "continuous" ? JointKind::kContinuous
                                                : JointKind::kPrismatic;
    if (auto fault = read_axis(element, *source, joint)) return fault;
    if (auto fault = read_limits(element, *source, joint)) return fault;
    if (auto fault = read_dynamics(element, *source, joint)) return fault;
    joint.mimics = source->mimic != nullptr;
    model_.joints.push_back(std::move(joint));
    return std::nullopt;
  }

  [[nodiscard]] Fault read_axis(const UrdfElement& element, const urdf::Joint& source,
                                RobotJoint& joint) const {
    const Eigen::Vector3d axis = vector_of(source.axis);
    const double length = axis.norm();
    if (!(length > 1e-6 && std::isfinite(length))) {
      return finding(element, "joint", "axis has no direction",
                     "set <axis xyz=\"...\"/> to a vector other than zero");
    }
    // An exact unit vector is not divided, so that the axes of a frame stay free of rounding.
    joint.axis = length == 1.0 ? axis : Eigen::Vector3d(axis / length);
    return std::nullopt;
  }

  [[nodiscard]] Fault read_dynamics(const UrdfElement& element, const urdf::Joint& source,
                                    RobotJoint& joint) const {
    if (!source.dynamics) return std::nullopt;
    const urdf::JointDynamics& dynamics = *source.dynamics;
    for (const auto& [name, value] :
         {std::pair("damping", dynamics.damping), std::pair("friction", dynamics.friction)}) {
      if (value >= 0.0 && value < kMaxFriction) continue;
      return finding(
          element, "joint",
          fmt::format("{} of <dynamics> is {:g}, not from 0 to {:g}", name, value, kMaxFriction),
          "correct its <dynamics>, in N m s/rad and N m (N s/m and N), or remove it");
    }
    joint.damping = dynamics.damping;
    joint.friction = dynamics.friction;
    return std::nullopt;
  }

  Fault read_limits(const UrdfElement& element, const urdf::Joint& source, RobotJoint& joint) {
    if (!source.limits) return std::nullopt;
    const urdf::JointLimits& limits = *source.limits;
    if (!std::isfinite(limits.lower + limits.upper + limits.velocity + limits.effort)) {
      return finding(element, "joint", "limits are not finite", "correct its <limit>");
    }
    if (limits.velocity < 0.0 || limits.effort < 0.0) {
      return finding(
          element, "joint",
          fmt::format("negative limit: velocity {:g}, effort {:g}", limits.velocity, limits.effort),
          "write limits as positive numbers");
    }
    if (limits.velocity > 0.0) joint.limits.velocity = limits.velocity;
    if (limits.effort > 0.0) joint.limits.effort = limits.effort;
    if (limits.velocity == 0.0 || limits.effort == 0.0) {
      warn(finding(
          element, "joint",
          fmt::format("no limit of {}: it is 0", limits.velocity > 0.0 ? "effort"
                                                 : limits.effort > 0.0 ? "velocity"
                                                                       : "velocity and effort"),
          "add the value of the data sheet to its <limit>"));
    }
    return read_range(element, limits, joint);
  }

  Fault read_range(const UrdfElement& element, const urdf::JointLimits& limits, RobotJoint& joint) {
    if (joint.kind == JointKind::kContinuous) {
      if (limits.lower != 0.0 || limits.upper != 0.0) {
        warn(finding(
            element, "joint",
            fmt::format("continuous, yet limited to {:g} ... {:g} rad: the limits are ignored",
                        limits.lower, limits.upper),
            "make it revolute if they hold"));
      }
      return std::nullopt;
    }
    if (limits.lower > limits.upper) {
      return finding(element, "joint",
                     fmt::format("limits reversed: lower {:g} is above upper {:g}", limits.lower,
                                 limits.upper),
                     "swap lower and upper");
    }
    if (limits.lower == limits.upper) {
      warn(finding(element, "joint", fmt::format("cannot move: both limits are {:g}", limits.lower),
                   "make it a fixed joint, or correct the limits"));
    }
    joint.limits.lower = limits.lower;
    joint.limits.upper = limits.upper;
    return std::nullopt;
  }

  Fault read_inertia(const UrdfElement& element, const urdf::Link& source, RobotLink& link) const {
    if (!source.inertial) return std::nullopt;
    const urdf::Inertial& inertial = *source.inertial;
    const Eigen::Matrix3d inertia{{inertial.ixx, inertial.ixy, inertial.ixz},
                                  {inertial.ixy, inertial.iyy, inertial.iyz},
                                  {inertial.ixz, inertial.iyz, inertial.izz}};
    if (!(is_plausible(inertial.origin) && inertial.mass < kMaxMass && inertia.allFinite() &&
          inertia.cwiseAbs().maxCoeff() < kMaxInertia)) {
      return finding(
          element, "link",
          fmt::format("mass, inertia or centre of mass is too large: {:g} kg or more, {:g} "
                      "kg m^2 or {:g} m",
                      kMaxMass, kMaxInertia, kMaxLength),
          "correct its <inertial>; units are kg and m");
    }
    if (inertial.mass < 0.0) {
      return finding(element, "link", fmt::format("mass {:g} kg is negative", inertial.mass),
                     "correct its <inertial>, or leave it out for kinematics");
    }
    link.inertia = transform(pose_of(inertial.origin),
                             RigidInertia{inertial.mass, Eigen::Vector3d::Zero(), inertia});
    return std::nullopt;
  }

  /// A <visual> or <collision> of a link.
  struct ShapePlace {
    const UrdfElement& link;
    const char* kind;
    std::size_t index;  ///< among those of its kind
  };
  [[nodiscard]] Error shape_finding(const ShapePlace& place, const std::string& message,
                                    std::string hint) const {
    return finding(place.link, "link",
                   fmt::format("{} {}: {}", place.kind, place.index + 1, message), std::move(hint));
  }

  /// Adds the shape, unless it has no extent: it can neither be seen nor touched then.
  template <typename Part>
  Fault add_shape(const ShapePlace& place, const Part* part, std::vector<RobotShape>& shapes) {
    const auto fault = [&](const std::string& message) {
      return shape_finding(place, message, fmt::format("correct its <{}>", place.kind));
    };
    if (part == nullptr || !part->geometry) return fault("has no geometry");
    if (!is_plausible(part->origin)) return fault("origin is too far away");
    const Eigen::Vector3d size = size_of(*part->geometry);
    if (!(size.allFinite() && size.minCoeff() >= 0.0)) {
      return fault("a dimension or scale is not positive");
    }
    if (size.maxCoeff() >= kMaxLength) {
      return fault(fmt::format("a dimension or scale is {:g} or more", kMaxLength));
    }
    if (size.minCoeff() == 0.0) {
      warn(shape_finding(place, "a dimension or scale is 0: it is left out",
                         fmt::format("correct or remove its <{}>", place.kind)));
      return std::nullopt;
    }
    RobotShape shape;
    shape.name = part->name;
    shape.T_link_shape = pose_of(part->origin);
    if (auto missing = set_geometry(place, *part->geometry, shape)) return missing;
    shapes.push_back(std::move(shape));
    return std::nullopt;
  }

  /// Edges, radius and length [m], or the scale of a mesh, which may mirror it.
  static Eigen::Vector3d size_of(const urdf::Geometry& geometry) {
    switch (geometry.type) {
      case urdf::Geometry::BOX:
        return vector_of(static_cast<const urdf::Box&>(geometry).dim);
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        return {cylinder.radius, cylinder.length, cylinder.length};
      }
      case urdf::Geometry::SPHERE:
        return Eigen::Vector3d::Constant(static_cast<const urdf::Sphere&>(geometry).radius);
      default:
        return vector_of(static_cast<const urdf::Mesh&>(geometry).scale).cwiseAbs();
    }
  }

  Fault set_geometry(const ShapePlace& place, const urdf::Geometry& geometry, RobotShape& shape) {
    const Eigen::Vector3d size = size_of(geometry);
    switch (geometry.type) {
      case urdf::Geometry::BOX:
        shape.geometry = BoxShape{size};
        return std::nullopt;
      case urdf::Geometry::CYLINDER:
        shape.geometry = CylinderShape{size.x(), size.y()};
        return std::nullopt;
      case urdf::Geometry::SPHERE:
        shape.geometry = SphereShape{size.x()};
        return std::nullopt;
      default:
        return find_mesh(place, static_cast<const urdf::Mesh&>(geometry), shape);
    }
  }

  Fault find_mesh(const ShapePlace& place, const urdf::Mesh& mesh, RobotShape& shape) {
    const MeshReference found = resolve_mesh(mesh.filename, file_, options_.package_folders);
    shape.geometry = MeshShape{found.file, mesh.filename, vector_of(mesh.scale)};
    if (!found.file.empty() || !missing_meshes_.insert(mesh.filename).second) return std::nullopt;
    Error missing =
        found.is_outside
            ? shape_finding(place,
                            fmt::format("mesh {} is not read: it is outside the description's "
                                        "folder",
                                        mesh.filename),
                            "copy the mesh there, or name its folder in ROS_PACKAGE_PATH")
            : shape_finding(place, fmt::format("no mesh at {}", mesh.filename),
                            mesh.filename.starts_with("package://")
                                ? "name the folder of its package in ROS_PACKAGE_PATH"
                                : "the path starts in the folder of the description");
    if (options_.requires_meshes) return missing;
    warn(std::move(missing));
    return std::nullopt;
  }

  /// Coordinates in the order of the joints that have their own.
  Fault connect_mimics() {
    for (RobotJoint& joint : model_.joints) {
      if (!joint.mimics) joint.coordinate = model_.dof++;
    }
    for (RobotJoint& joint : model_.joints) {
      if (auto fault = connect_mimic(joint)) return fault;
    }
    return std::nullopt;
  }

  /// Connects the joint through a chain of leaders, if these mimic others in turn.
  Fault connect_mimic(RobotJoint& joint) {
    const UrdfElement element = joint_element(joint.name);
    std::string name = joint.name;
    for (std::size_t steps = 0; description_.getJoint(name)->mimic; ++steps) {
      const urdf::JointMimic& mimic = *description_.getJoint(name)->mimic;
      const auto leader = model_.joint_index(mimic.joint_name);
      if (!leader) {
        return finding(element, "joint",
                       fmt::format("mimics '{}', which is no movable joint", mimic.joint_name),
                       "correct the name in its <mimic>");
      }
      if (steps == model_.joints.size()) {
        return finding(element, "joint", "mimics itself, by way of others",
                       "one of the joints must move of its own");
      }
      joint.offset += joint.multiplier * mimic.offset;
      joint.multiplier *= mimic.multiplier;
      if (!(std::abs(joint.multiplier) < kMaxRatio && std::abs(joint.offset) < kMaxRatio)) {
        return finding(element, "joint", "multiplier or offset is too large",
                       "correct its <mimic>");
      }
      joint.coordinate = model_.joints[*leader].coordinate;
      name = mimic.joint_name;
    }
    return std::nullopt;
  }

  [[nodiscard]] const UrdfElement& joint_element(const std::string& name) const {
    for (const UrdfJointElement& joint : structure_.joints) {
      if (joint.name == name) return joint;
    }
    return structure_.joints.front();  // not reached: all joints of the model are there
  }

  void merge_inertias() {
    for (const RobotLink& link : model_.links) {
      if (!link.joint || !link.inertia) continue;
      RigidInertia& body = model_.joints[*link.joint].body;
      body = body + transform(link.T_joint_link, *link.inertia);
    }
  }

  void warn(Error finding) { model_.warnings.push_back(std::move(finding)); }

  const urdf::ModelInterface& description_;
  const UrdfStructure& structure_;
  const std::filesystem::path& file_;
  const UrdfOptions& options_;
  RobotModel model_;
  std::set<std::string> missing_meshes_;
};

}  // namespace

Expected<RobotModel> build_robot(const urdf::ModelInterface& description,
                                 const UrdfStructure& structure, const std::filesystem::path& file,
                                 const UrdfOptions& options) {
  return RobotBuilder(description, structure, file, options).build();
}

}  // namespace pcavr::robot
