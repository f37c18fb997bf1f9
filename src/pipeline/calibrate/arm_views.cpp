// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/pipeline/calibrate_arm.hpp"
#include "pcavr/recordings/recording/csv_dialect.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "pose_input.hpp"
#include "yaml_text.hpp"

namespace pcavr {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr double kMaxNumber = 1e6;  ///< of a view

struct Arm {
  RobotModel model;
  std::size_t tip = 0;
  std::vector<std::size_t> chain = {};   ///< joints that carry the flange, from the base on
  std::vector<std::size_t> offset = {};  ///< coordinates that have an offset: revolute ones
};

Expected<Arm> read_arm(const ArmInput& input) {
  Expected<RobotModel> model = read_urdf(input.urdf);
  if (!model) return model.error();
  Arm arm{.model = *std::move(model)};
  arm.tip = default_tip(arm.model);
  if (!input.tip.empty()) {
    const std::optional<std::size_t> link = arm.model.link_index(input.tip);
    if (!link) {
      return Error{.message = "has no link '" + input.tip + "'",
                   .file = input.urdf,
                   .place = "--tip",
                   .hint = "name the link that is the flange"};
    }
    arm.tip = *link;
  }
  std::optional<std::size_t> joint = arm.model.links[arm.tip].joint;
  for (; joint; joint = arm.model.joints[*joint].parent) {
    if (!arm.model.joints[*joint].mimics) arm.chain.insert(arm.chain.begin(), *joint);
  }
  for (const std::size_t index : arm.chain) {
    const RobotJoint& one = arm.model.joints[index];
    if (one.kind != JointKind::kPrismatic) arm.offset.push_back(one.coordinate);
  }
  return arm;
}

/// A view's joint positions, by coordinate [rad, m].
struct JointRow {
  int number = 0, line = 0;
  Eigen::VectorXd q;
};

struct JointColumn {
  std::size_t column = 0, coordinate = 0;
  double factor = 1.0;  ///< [rad] or [m]
};

/// q_NAME, as `joints.csv` has it, or its number along the chain from 1.
Expected<std::vector<JointColumn>> joint_columns(const std::vector<std::string>& header,
                                                 const Arm& arm) {
  std::vector<JointColumn> columns;
  for (std::size_t i = 0; i < arm.chain.size(); ++i) {
    const RobotJoint& joint = arm.model.joints[arm.chain[i]];
    const std::string by_name = parse_column("q_" + joint.name).name;
    const auto found =
        find_column(header, {by_name, fmt::format("q_{}", i + 1), fmt::format("q{}", i + 1)});
    if (!found) {
      return Error{.message = "has no column of joint '" + joint.name + "'",
                   .line = 1,
                   .hint = "name it q_" + joint.name};
    }
    const bool is_degrees = found->unit == "deg" && joint.kind != JointKind::kPrismatic;
    if (!is_degrees && !found->unit.empty() && found->unit != "rad" && found->unit != "m") {
      return Error{.message = "has joint '" + joint.name + "' in '" + found->unit + "'",
                   .line = 1,
                   .hint = "give rad, deg or m"};
    }
    columns.push_back({found->column, joint.coordinate, is_degrees ? kRadiansPerDegree : 1.0});
  }
  return columns;
}

Expected<JointRow> joint_row(const std::vector<std::string>& fields, std::size_t number_column,
                             const std::vector<JointColumn>& columns, std::size_t dof) {
  const auto number_in = [&](std::size_t column) {
    return column < fields.size() ? parse_number(fields[column]) : std::nullopt;
  };
  const std::optional<double> number = number_in(number_column);
  if (!number || *number < 0.0 || *number > kMaxNumber || *number != static_cast<int>(*number)) {
    return Error{.message = "has no number of a view", .hint = "--skip-bad leaves such rows out"};
  }
  JointRow row{.number = static_cast<int>(*number),
               .q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(dof))};
  for (const JointColumn& column : columns) {
    const std::optional<double> position = number_in(column.column);
    if (!position) {
      return Error{.message = "has no position of a joint",
                   .hint = "--skip-bad leaves such rows out"};
    }
    row.q[static_cast<Eigen::Index>(column.coordinate)] = column.factor * *position;
  }
  return row;
}

Expected<std::vector<JointRow>> read_joint_rows(const ArmInput& input, const Arm& arm) {
  const Expected<std::string> text = read_file(input.table);
  if (!text) return text.error();
  LineReader lines(*text);
  const auto at = [&](Error error) {
    error.file = input.table;
    if (error.line == 0) error.line = lines.line();
    return error;
  };
  const std::string header(lines.next().value_or(""));
  const char separator = separator_of(header);
  const std::vector<std::string> names = split_fields(separator, header);
  const auto number = find_column(names, {"index", "view", "number"});
  if (!number) {
    return at({.message = "has no column index, the number of the view",
               .line = 1,
               .hint = "name the columns index, and q_NAME for each joint"});
  }
  const Expected<std::vector<JointColumn>> columns = joint_columns(names, arm);
  if (!columns) return at(columns.error());
  std::vector<JointRow> rows;
  std::set<int> numbers;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty() || trimmed(*line).starts_with('#')) continue;
    Expected<JointRow> row =
        joint_row(split_fields(separator, *line), number->column, *columns, arm.model.dof);
    if (!row && input.skip_bad) continue;
    if (!row) return at(row.error());
    row->line = lines.line();
    if (!numbers.insert(row->number).second) {
      return at({.message = fmt::format("view {} is there twice", row->number),
                 .hint = "number each view once"});
    }
    rows.push_back(*std::move(row));
  }
  return rows;
}

/// The arm in each view, which owns what it computes with.
ArmModel arm_model(Arm arm, std::vector<Eigen::VectorXd> positions) {
  struct State {
    Arm arm;
    RobotDynamics dynamics;
    std::vector<Eigen::VectorXd> positions;
    Matrix6Xd jacobian;
  };
  RobotDynamics dynamics(arm.model);
  const auto dof = static_cast<Eigen::Index>(arm.model.dof);
  const auto state =
      std::make_shared<State>(State{std::move(arm), std::move(dynamics), std::move(positions), {}});
  state->jacobian.setZero(6, dof);
  return [state](std::size_t view, const Eigen::VectorXd& offsets) {
    const std::vector<std::size_t>& shifted = state->arm.offset;
    Eigen::VectorXd q = state->positions[view];
    for (std::size_t i = 0; i < shifted.size(); ++i) {
      q[static_cast<Eigen::Index>(shifted[i])] += offsets[static_cast<Eigen::Index>(i)];
    }
    state->dynamics.jacobian(q, state->arm.tip, state->jacobian);
    ArmPose pose{.T_base_flange = state->dynamics.T_base_link(state->arm.tip)};
    pose.jacobian_base.resize(6, static_cast<Eigen::Index>(shifted.size()));
    for (std::size_t i = 0; i < shifted.size(); ++i) {
      pose.jacobian_base.col(static_cast<Eigen::Index>(i)) =
          state->jacobian.col(static_cast<Eigen::Index>(shifted[i]));
    }
    return pose;
  };
}

}  // namespace

Expected<PairedArm> read_arm_views(const ArmInput& robot, const PoseInput& camera) {
  Expected<Arm> arm = read_arm(robot);
  if (!arm) return arm.error();
  Expected<std::vector<JointRow>> rows = read_joint_rows(robot, *arm);
  if (!rows) return rows.error();
  const Expected<PoseList> boards = read_pose_input(camera);
  if (!boards) return boards.error();
  std::map<int, const JointRow*> by_number;
  for (const JointRow& row : *rows) by_number[row.number] = &row;
  PairedArm found;
  std::vector<Eigen::VectorXd> positions;
  std::set<int> numbers;
  for (const ListedPose& board : boards->poses) {
    if (!numbers.insert(board.number).second) {
      return Error{.message = fmt::format("view {} is there twice", board.number),
                   .file = board.file,
                   .line = board.line,
                   .hint = "number each view once"};
    }
    const auto row = by_number.find(board.number);
    if (row == by_number.end()) continue;
    found.paired.views.push_back({fmt::format("view {}", board.number), Pose{}, board.pose});
    positions.push_back(row->second->q);
  }
  if (positions.empty()) {
    return Error{.message = "no view has the number of one of " + robot.table,
                 .file = boards->source,
                 .hint = "number the views of both alike"};
  }
  const std::size_t alone = rows->size() + boards->poses.size() - 2 * positions.size();
  found.paired.notes = boards->notes;
  if (alone > 0) {
    found.paired.notes.push_back(fmt::format("{} rows have no view of the other: left out", alone));
  }
  found.paired.formats = {
      fmt::format("joint positions of {} joints, {} rows", arm->chain.size(), rows->size()),
      boards->format};
  for (const std::size_t joint : arm->chain) {
    const RobotJoint& one = arm->model.joints[joint];
    if (one.kind != JointKind::kPrismatic) found.joints.push_back(one.name);
  }
  const auto offsets = static_cast<Eigen::Index>(arm->offset.size());
  found.arm = arm_model(*std::move(arm), std::move(positions));
  for (std::size_t i = 0; i < found.paired.views.size(); ++i) {
    found.paired.views[i].T_base_flange =
        found.arm(i, Eigen::VectorXd::Zero(offsets)).T_base_flange;
  }
  return found;
}

std::string format_joint_offsets(const ArmHandEyeResult& found) {
  std::string text =
      "joint_offsets:  # rad, to add to what is read; held: not shown by the views\n";
  for (const JointOffset& offset : found.offsets) {
    text += fmt::format("  - {{joint: {}, offset: {}, std: {}}}\n", quoted(offset.joint),
                        shortest_decimal(offset.value),
                        offset.is_held ? "~" : shortest_decimal(offset.std));
  }
  if (found.without.held_out_rms) {
    text += "held_out_rms_without_offsets: " + shortest_decimal(*found.without.held_out_rms) +
            "  # m\n";
  }
  return text;
}

}  // namespace pcavr
