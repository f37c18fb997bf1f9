// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <charconv>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "pcavr/robots/robot_identification/log_checks.hpp"

namespace pcavr {
namespace {

std::optional<std::size_t> number_of(const std::string& name) {
  std::size_t number = 0;
  const auto [end, code] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (code != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  return number;
}

/// Joints that the log may name: those that mimic no other, along the chain.
std::vector<std::string> leading_joints(const RobotModel& model) {
  std::vector<std::string> names;
  for (const std::size_t joint : model.coordinate_joints()) {
    names.push_back(model.joints[joint].name);
  }
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The name without the usual differences between a controller's names and a description's: letter
/// case, `_`, `-`.
std::string plain(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (c != '_' && c != '-')
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

/// The only one of `names` that is `name` but for case and separators; nothing where several are.
std::optional<std::size_t> similar_joint(const std::string& name,
                                         const std::vector<std::string>& names) {
  std::optional<std::size_t> similar;
  for (std::size_t joint = 0; joint < names.size(); ++joint) {
    if (plain(names[joint]) != plain(name)) continue;
    if (similar) return std::nullopt;
    similar = joint;
  }
  return similar;
}

/// The index in `names` of each of the log's joints; an Error where one is none of them.
Expected<std::vector<std::size_t>> joints_of(const JointLog& log,
                                             const std::vector<std::string>& names) {
  const bool is_numbered = std::all_of(log.joints.begin(), log.joints.end(),
                                       [](const auto& name) { return number_of(name); });
  const bool is_named = std::all_of(log.joints.begin(), log.joints.end(), [&](const auto& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  });
  std::size_t first = 1;
  for (const std::string& name : log.joints) {
    if (is_numbered) first = std::min(first, *number_of(name));
  }
  std::vector<std::size_t> joints;
  for (const std::string& name : log.joints) {
    const auto found = std::find(names.begin(), names.end(), name);
    std::size_t joint = static_cast<std::size_t>(found - names.begin());
    if (is_numbered && !is_named) joint = *number_of(name) - first;
    if (joint == names.size()) joint = similar_joint(name, names).value_or(joint);
    if (joint >= names.size()) {
      return Error{
          .message = fmt::format("the robot has no movable joint '{}'", name),
          .line = 1,
          .place = "q_" + name,
          .hint = fmt::format("rename the log's columns: the robot's joints are {}; numbers "
                              "count along the chain",
                              listed(names))};
    }
    joints.push_back(joint);
  }
  return joints;
}

}  // namespace

Expected<MatchedRobot> match_joints(const JointLog& log, const RobotModel& model) {
  const std::vector<std::string> names = leading_joints(model);
  const Expected<std::vector<std::size_t>> joints = joints_of(log, names);
  if (!joints) return joints.error();
  MatchedRobot matched;
  std::vector<LockedJoint> locked;
  for (std::size_t joint = 0; joint < names.size(); ++joint) {
    const auto found = std::find(joints->begin(), joints->end(), joint);
    if (found == joints->end()) {
      locked.push_back({names[joint], 0.0});
      continue;
    }
    matched.columns.push_back(static_cast<std::size_t>(found - joints->begin()));
  }
  if (matched.columns.size() != log.joints.size()) {
    return Error{.message = "two columns of the log are the same joint", .line = 1};
  }
  if (!locked.empty()) {
    std::vector<std::string> still;
    for (const LockedJoint& joint : locked) still.push_back(joint.name);
    matched.notes.push_back("joints that the log does not have stand still at 0: " + listed(still));
  }
  matched.model = lock_joints(model, locked);
  return matched;
}

JointLog reordered(const JointLog& log, const std::vector<std::size_t>& columns) {
  JointLog ordered = log;
  const auto move = [&](const Eigen::MatrixXd& from, Eigen::MatrixXd& to) {
    if (from.rows() == 0) return;
    for (std::size_t j = 0; j < columns.size(); ++j) {
      to.col(static_cast<Eigen::Index>(j)) = from.col(static_cast<Eigen::Index>(columns[j]));
    }
  };
  move(log.position, ordered.position);
  move(log.velocity, ordered.velocity);
  move(log.torque, ordered.torque);
  move(log.current, ordered.current);
  for (std::size_t j = 0; j < columns.size(); ++j) ordered.joints[j] = log.joints[columns[j]];
  return ordered;
}

}  // namespace pcavr
