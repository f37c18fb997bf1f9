// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "robots/robot/urdf_builder.hpp"

namespace pcavr::robot {
namespace {

int line_of(const UrdfStructure& structure, const std::string& link) {
  const auto found = std::find_if(structure.links.begin(), structure.links.end(),
                                  [&](const UrdfElement& element) { return element.name == link; });
  return found == structure.links.end() ? 0 : found->line;
}

bool have_same_inertia(const RigidInertia& a, const RigidInertia& b) {
  return a.mass == b.mass && a.inertia_at_com == b.inertia_at_com;
}

/// Exactly the same numbers on all moving links do not come from a CAD system.
bool are_placeholders(const std::vector<const RobotLink*>& links) {
  return links.size() >= 3 && std::all_of(links.begin(), links.end(), [&](const RobotLink* link) {
           return have_same_inertia(*link->inertia, *links.front()->inertia);
         });
}

/// The links' distances from joint to joint, added: no arm reaches farther.
double reach(const RobotModel& model) {
  double sum = 0.0;
  for (const RobotJoint& joint : model.joints) sum += joint.T_parent_joint.translation().norm();
  return sum;
}

/// A round number about all axes: 0.001 0 0 0.001 0 0.001.
bool is_round_ball(const Eigen::Matrix3d& inertia) {
  const double moment = inertia(0, 0);
  return moment > 0.0 && inertia == Eigen::Matrix3d(moment * Eigen::Matrix3d::Identity()) &&
         std::abs(std::stod(fmt::format("{:.0e}", moment)) - moment) < 1e-12 * moment;
}

/// Collects what is wrong with one model.
class InertiaCheck {
 public:
  InertiaCheck(const RobotModel& model, const UrdfStructure& structure)
      : model_(model), structure_(structure) {
    for (const RobotLink& link : model.links) {
      if (link.joint && link.inertia) moving_.push_back(&link);
    }
  }

  InertiaFindings run() {
    if (model_.joints.empty()) return {};
    if (moving_.empty()) {
      findings_.faults.push_back(
          {"no moving link has an inertia", model_.file.string(), 0, "",
           "enough for kinematics; dynamics need <inertial> in each moving link"});
      return std::move(findings_);
    }
    if (are_placeholders(moving_)) {
      add(findings_.faults, moving_.front()->name,
          fmt::format("all {} moving links have the same mass ({:g} kg) and inertia: placeholders",
                      moving_.size(), moving_.front()->inertia->mass),
          "replace them by the values of the data sheet, or identify them");
    }
    for (const RobotLink* link : moving_) check_link(*link);
    check_bodies();
    return std::move(findings_);
  }

 private:
  void add(std::vector<Error>& list, const std::string& link, std::string message,
           std::string hint) const {
    list.push_back({std::move(message), model_.file.string(), line_of(structure_, link),
                    fmt::format("link '{}'", link), std::move(hint)});
  }

  void check_link(const RobotLink& link) {
    const RigidInertia& inertia = *link.inertia;
    if (const auto fault = physical_fault(inertia)) {
      add(findings_.faults, link.name, *fault, "correct its <inertial>");
      return;
    }
    if (inertia.inertia_at_com.isZero(0.0)) {
      add(findings_.faults, link.name,
          fmt::format("mass is {:g} kg, and the inertia 0", inertia.mass),
          "correct its <inertial>");
      return;
    }
    const double radius = std::sqrt(0.5 * inertia.inertia_at_com.trace() / inertia.mass);
    const double max_radius = reach(model_);
    if (max_radius > 0.0 && radius > max_radius) {
      add(findings_.doubts, link.name,
          fmt::format(
              "inertia too large for its mass: radius of gyration {:.2g} m, the whole robot "
              "reaches {:.2g} m",
              radius, max_radius),
          "correct its <inertial>");
    } else if (is_round_ball(inertia.inertia_at_com)) {
      add(findings_.doubts, link.name,
          fmt::format("inertia is {:g} kg m^2 about all axes: a placeholder?",
                      inertia.inertia_at_com(0, 0)),
          "replace it by the value of the data sheet, or identify it");
    }
  }

  void check_bodies() {
    for (const RobotJoint& joint : model_.joints) {
      if (joint.body.mass > 0.0) continue;
      add(findings_.faults, joint.child_link,
          fmt::format("moves with joint '{}' and has no mass", joint.name),
          "add its <inertial>; without it, dynamics treat it as weightless");
    }
  }

  const RobotModel& model_;
  const UrdfStructure& structure_;
  std::vector<const RobotLink*> moving_;
  InertiaFindings findings_;
};

}  // namespace

InertiaFindings check_inertias(const RobotModel& model, const UrdfStructure& structure) {
  return InertiaCheck(model, structure).run();
}

}  // namespace pcavr::robot
