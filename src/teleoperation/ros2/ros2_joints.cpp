// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "ros2_joints.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/robots/robot/urdf.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxJoints = 1000;     // of a message: all of a plant's
constexpr double kMaxPosition = 1e4;         // [rad] or [m] of a joint without limits
constexpr double kRelativeTolerance = 0.01;  // of the range: arms at a stop measure beyond it

Error unusable(const std::string& joint, const char* what) {
  return {.message = "position of joint " + joint + " is " + what};
}

/// The coordinates of the joints between the root and a link.
std::set<std::size_t> coordinates_to(const RobotModel& model, std::size_t link) {
  std::set<std::size_t> found;
  for (std::optional<std::size_t> at = model.links[link].joint; at; at = model.joints[*at].parent) {
    found.insert(model.joints[*at].coordinate);
  }
  return found;
}

}  // namespace

Ros2ToolJoints::Ros2ToolJoints(const RobotModel& model, std::size_t base, std::size_t tip)
    : kinematics_(model),
      tip_(tip),
      q_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.dof))) {
  PCAVR_REQUIRE(base < model.links.size() && tip < model.links.size(), base, tip);
  PCAVR_REQUIRE(!model.links[base].joint, base);
  T_base_root_ = model.links[base].T_joint_link.inverse();
  const std::vector<std::size_t> leaders = model.coordinate_joints();
  for (const std::size_t coordinate : coordinates_to(model, tip)) {
    const RobotJoint& joint = model.joints[leaders[coordinate]];
    const double lower = joint.limits.lower.value_or(-kMaxPosition);
    const double upper = joint.limits.upper.value_or(kMaxPosition);
    const double tolerance = kRelativeTolerance * (upper - lower);
    joints_.push_back(
        {joint.name, static_cast<Eigen::Index>(coordinate), lower - tolerance, upper + tolerance});
  }
}

Expected<Pose> Ros2ToolJoints::T_base_tool(const RosJointState& state) {
  if (state.names.size() > kMaxJoints) return Error{.message = "has more than 1000 joints"};
  if (state.position.size() != state.names.size()) {
    return Error{.message = "numbers of names and positions differ"};
  }
  for (const Joint& joint : joints_) {
    const auto at = std::find(state.names.begin(), state.names.end(), joint.name);
    if (at == state.names.end()) return Error{.message = "has no position of joint " + joint.name};
    if (std::find(at + 1, state.names.end(), joint.name) != state.names.end()) {
      return Error{.message = "has joint " + joint.name + " twice"};
    }
    const double position = state.position[static_cast<std::size_t>(at - state.names.begin())];
    if (!std::isfinite(position)) return unusable(joint.name, "not finite");
    if (position < joint.lower || position > joint.upper) {
      return unusable(joint.name, "beyond its limits");
    }
    q_[joint.coordinate] = position;
  }
  kinematics_.forward_kinematics(q_);
  return T_base_root_ * kinematics_.T_base_link(tip_);
}

Ros2JointCommand::Ros2JointCommand(const RobotModel& model, std::size_t base, std::size_t tip)
    : inverse_kinematics_(model, tip),
      T_root_base_(model.links[base].T_joint_link),
      q_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.dof))) {
  const std::vector<std::size_t> leaders = model.coordinate_joints();
  for (const std::size_t coordinate : coordinates_to(model, tip)) {
    names_.push_back(model.joints[leaders[coordinate]].name);
    coordinates_.push_back(static_cast<Eigen::Index>(coordinate));
  }
  positions_.resize(names_.size());
}

double Ros2JointCommand::follow(const Pose& T_base_tool, double dt) {
  const IkResult result = inverse_kinematics_.follow(T_root_base_ * T_base_tool, dt, q_);
  for (std::size_t i = 0; i < coordinates_.size(); ++i) positions_[i] = q_[coordinates_[i]];
  return result.position_error;
}

namespace {

/// The links of the tip and of the base, in the description that the setup names.
struct ToolLinks {
  RobotModel model;
  std::size_t base = 0, tip = 0;
};

Expected<ToolLinks> read_tool_links(const Ros2Setup& setup) {
  Expected<RobotModel> model = read_urdf(setup.tool_urdf);
  if (!model) return model.error();
  const auto tip = model->link_index(setup.tool_link);
  const auto base = model->link_index(setup.base_frame);
  if (!tip || !model->links[*tip].joint) {
    return Error{.message = setup.tool_link + " is not a link that joints move",
                 .file = setup.tool_urdf.string(),
                 .hint = "give tool.link the link whose origin is the tip"};
  }
  if (!base || model->links[*base].joint) {
    return Error{.message = setup.base_frame + " is not a link fixed to the root",
                 .file = setup.tool_urdf.string(),
                 .hint =
                     "give base_frame a link that does not move, and add it to the description "
                     "where it is none of it"};
  }
  return ToolLinks{std::move(*model), *base, *tip};
}

}  // namespace

Expected<Ros2ToolJoints> read_tool_joints(const Ros2Setup& setup) {
  const Expected<ToolLinks> links = read_tool_links(setup);
  if (!links) return links.error();
  return Ros2ToolJoints(links->model, links->base, links->tip);
}

Expected<Ros2JointCommand> read_joint_command(const Ros2Setup& setup) {
  const Expected<ToolLinks> links = read_tool_links(setup);
  if (!links) return links.error();
  return Ros2JointCommand(links->model, links->base, links->tip);
}

}  // namespace pcavr
