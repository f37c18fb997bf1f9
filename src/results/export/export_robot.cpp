// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/export/export_robot.hpp"

#include <algorithm>
#include <optional>
#include <variant>

#include <fmt/format.h>

namespace pcavr {
namespace {

struct JointValue {
  double value = 0.0;
  std::optional<double> std = {};
};

JointValue equivalent_of(const JointFit& fit, FrictionTerm term) {
  const auto found = std::find_if(fit.equivalent.begin(), fit.equivalent.end(),
                                  [&](const FittedTerm& each) { return each.term == term; });
  if (found == fit.equivalent.end()) return {};
  return {.value = found->value, .std = found->std};
}

/// Of a viscous, a Coulomb or a constant term, by the joint's kind.
const char* unit_in(const RobotJoint& joint, FrictionTerm term) {
  if (joint.kind != JointKind::kPrismatic) return unit_of(term);
  return term == FrictionTerm::viscous ? "N s/m" : "N";
}

/// Records a value of a joint; engines have no negative friction.
double add_friction(const RobotJoint& joint, FrictionTerm term, const std::string& key,
                    const JointFit& fit, ExportedRobot& robot) {
  const JointValue found = equivalent_of(fit, term);
  const double written = std::max(found.value, 0.0);
  robot.numbers.push_back({.object = joint.name,
                           .key = key,
                           .value = written,
                           .std = found.std,
                           .unit = unit_in(joint, term),
                           .origin = "measured"});
  if (written != found.value) {
    robot.warnings.push_back(fmt::format("{}: identified with a negative {} friction: written as 0",
                                         joint.name, name_of(term)));
    robot.residuals.push_back({.object = joint.name,
                               .what = fmt::format("{} friction", name_of(term)),
                               .wanted = found.value,
                               .written = written,
                               .unit = unit_in(joint, term)});
  }
  return written;
}

/// What a joint of engines does not have: the constant torque, and what was fitted beyond it.
void add_joint_residuals(const RobotJoint& joint, const JointFit& fit, ExportedRobot& robot) {
  std::string others;
  for (const FittedTerm& term : fit.friction) {
    const bool is_written = term.term == FrictionTerm::viscous ||
                            term.term == FrictionTerm::coulomb ||
                            term.term == FrictionTerm::motor_inertia;
    if (is_written || term.term == FrictionTerm::offset) continue;
    others += (others.empty() ? "fitted, and projected on these two: " : ", ") +
              std::string(name_of(term.term));
  }
  const bool is_prismatic = joint.kind == JointKind::kPrismatic;
  robot.residuals.push_back({.object = joint.name,
                             .what = is_prismatic ? "constant force" : "constant torque",
                             .wanted = equivalent_of(fit, FrictionTerm::offset).value,
                             .written = 0.0,
                             .unit = unit_in(joint, FrictionTerm::offset),
                             .remark = others});
}

std::vector<std::string> joints_beyond(const RobotModel& described, const RobotModel& identified) {
  std::vector<std::string> names;
  for (const RobotJoint& joint : described.joints) {
    if (!identified.joint_index(joint.name)) names.push_back(joint.name);
  }
  return names;
}

/// Meshes that are named by a relative path are not found from another folder.
void warn_of_relative_meshes(const RobotModel& model, ExportedRobot& robot) {
  std::size_t count = 0;
  for (const RobotLink& link : model.links) {
    for (const auto* shapes : {&link.visuals, &link.collisions}) {
      count += static_cast<std::size_t>(
          std::count_if(shapes->begin(), shapes->end(), [](const RobotShape& shape) {
            const auto* mesh = std::get_if<MeshShape>(&shape.geometry);
            return mesh != nullptr && mesh->reference.find("://") == std::string::npos &&
                   !std::filesystem::path(mesh->reference).is_absolute();
          }));
    }
  }
  if (count == 0) return;
  robot.warnings.push_back(
      fmt::format("{}: names {} meshes by paths relative to the description's folder: copy {} "
                  "there, or the meshes beside it",
                  model.name, count, kRobotUrdfFile));
}

}  // namespace

Expected<ExportedRobot> make_exported_robot(const RobotModel& described,
                                            const IdentifiedArm& identified) {
  ExportedRobot robot;
  robot.model = identified.model;
  robot.locked = joints_beyond(described, identified.model);
  for (const std::string& name : robot.locked) {
    robot.warnings.push_back(name + ": not identified: fixed at 0");
  }
  for (std::size_t j = 0; j < robot.model.joints.size(); ++j) {
    const RobotJoint& joint = robot.model.joints[j];
    const JointFit& fit = identified.joints[joint.coordinate];
    if (fit.equivalent.empty()) {
      return Error{.message = fmt::format("joint '{}' has no identified friction", joint.name),
                   .hint = "it rests in the log: identify the arm with a log in which it moves"};
    }
    ExportedJoint exported{.name = joint.name};
    exported.damping = add_friction(joint, FrictionTerm::viscous, "damping", fit, robot);
    exported.friction = add_friction(joint, FrictionTerm::coulomb, "friction", fit, robot);
    robot.joints.push_back(exported);
    add_joint_residuals(joint, fit, robot);
  }
  warn_of_relative_meshes(described, robot);
  return robot;
}

}  // namespace pcavr
