// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/series_import.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pcavr/base/core/input_ranges.hpp"

namespace pcavr {
namespace {

constexpr std::string_view kToolAxes = "tool";  ///< --wrench-frame: those of the tool's poses

void leave_out_row(ImportedStream& stream, const std::string& reason) {
  if (stream.left_out++ == 0) stream.left_out_reason = reason;
}

/// The rows with ascending and unique stamps; of rows with one stamp, the first of the bag is kept.
template <typename Value>
std::vector<const StampedValue<Value>*> sorted_rows(const CollectedTopic<Value>& topic,
                                                    ImportedStream& stream) {
  std::vector<const StampedValue<Value>*> rows;
  for (const auto& row : topic.rows) {
    if (!rows.empty() && row.stamp < rows.back()->stamp) ++stream.reordered;
    rows.push_back(&row);
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto* a, const auto* b) { return a->stamp < b->stamp; });
  const auto end = std::unique(rows.begin(), rows.end(),
                               [](const auto* a, const auto* b) { return a->stamp == b->stamp; });
  stream.duplicates = static_cast<std::size_t>(rows.end() - end);
  rows.erase(end, rows.end());
  return rows;
}

/// The nearest in time where the trajectory has none there; it is not empty.
Pose pose_near(const Trajectory& trajectory, Stamp stamp) {
  if (const std::optional<Pose> pose = trajectory.at(stamp)) return *pose;
  const std::vector<TimedPose>& poses = trajectory.poses();
  const auto after = std::lower_bound(poses.begin(), poses.end(), stamp,
                                      [](const TimedPose& p, Stamp t) { return p.stamp < t; });
  if (after == poses.end()) return poses.back().pose;
  if (after == poses.begin()) return after->pose;
  return stamp - std::prev(after)->stamp < after->stamp - stamp ? std::prev(after)->pose
                                                                : after->pose;
}

/// The mean over `duration` [s] from the first row; zero for no duration.
FramedWrench tare_of(const std::vector<const StampedValue<FramedWrench>*>& rows, double duration) {
  FramedWrench mean{
      .force = Eigen::Vector3d::Zero(), .torque = Eigen::Vector3d::Zero(), .frame = {}};
  double count = 0.0;
  for (const auto* row : rows) {
    if (to_seconds(row->stamp - rows.front()->stamp) >= duration) break;
    count += 1.0;
    mean.force += (row->value.force - mean.force) / count;
    mean.torque += (row->value.torque - mean.torque) / count;
  }
  return mean;
}

std::vector<std::string> joints_to_import(const SurveyedTopic& topic) {
  const auto best =
      std::max_element(topic.joints.begin(), topic.joints.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first.size(), a.second) < std::pair(b.first.size(), b.second);
      });
  return best == topic.joints.end() ? std::vector<std::string>() : best->first;
}

/// The values of the joints in their order; empty where one is absent or not in range.
std::vector<double> joint_values(const RosJointState& state, const std::vector<double>& values,
                                 const std::vector<std::string>& joints) {
  std::vector<double> found;
  if (values.size() != state.names.size()) return found;
  for (const std::string& joint : joints) {
    const auto at = std::find(state.names.begin(), state.names.end(), joint);
    if (at == state.names.end()) return {};
    const double value = values[static_cast<std::size_t>(at - state.names.begin())];
    if (!ranges::kJoint.contains(value)) return {};
    found.push_back(value);
  }
  return found;
}

/// One row for each sample; without rows where a sample has none.
Eigen::MatrixXd joint_matrix(const std::vector<std::vector<double>>& rows, std::size_t joints) {
  const bool is_recorded =
      std::all_of(rows.begin(), rows.end(), [&](const auto& row) { return row.size() == joints; });
  if (!is_recorded) return {};
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(joints));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    matrix.row(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::RowVectorXd>(rows[i].data(), static_cast<Eigen::Index>(joints));
  }
  return matrix;
}

/// Names for a header of joints.csv.
Expected<void> check_joint_names(const std::vector<std::string>& names,
                                 const SurveyedTopic& topic) {
  for (const std::string& name : names) {
    const bool is_plain = !name.empty() && name.find_first_of(",\"\r\n\t ") == name.npos;
    if (!is_plain || std::count(names.begin(), names.end(), name) > 1) {
      return Error{.message = "joint name '" + name + "' can't be a column of joints.csv",
                   .place = topic.topic.name,
                   .hint = "names are unique, without spaces, commas and quotes"};
    }
  }
  return {};
}

}  // namespace

ImportedStream SeriesImporter::stream_of(const SurveyedTopic& topic,
                                         const std::string& file) const {
  ImportedStream stream{.file = file, .topic = topic.topic.name};
  stream.delay = topic.delay;
  stream.has_receive_stamps = stamps_.uses_log_time(topic) || topic.unstamped > 0;
  return stream;
}

Expected<SeriesImporter::FrameRoute> SeriesImporter::route_from(const std::string& frame,
                                                                const SurveyedTopic& topic) const {
  const std::string& base = selection_.base_frame;
  if (base.empty()) return FrameRoute{.text = frame.empty() ? "" : frame + ", taken as base"};
  if (frame == base) return FrameRoute{.text = base};
  if (frame.empty()) return FrameRoute{.text = "not stated, taken as " + base};
  if (auto links = streams_.frames.chain(base, frame)) {
    std::string text = chain_text(base, *links);
    return FrameRoute{.is_as_it_is = false, .links = *std::move(links), .text = std::move(text)};
  }
  const std::string message = "no TF chain from '" + base + "' to '" + frame + "'";
  if (selection_.is_base_frame_given) {
    return Error{.message = message,
                 .file = bag_.string(),
                 .place = topic.topic.name,
                 .hint = "choose another --base-frame, or record /tf and /tf_static too"};
  }
  observer_.on_warning(bag_.string() + ": " + topic.topic.name + ": " + message +
                       "; its poses are taken as they are; choose the frame with --base-frame");
  return FrameRoute{.text = frame + ", taken as " + base};
}

Expected<ImportedSeries<Trajectory>> SeriesImporter::poses(const SurveyedTopic& topic,
                                                           const std::string& file) const {
  ImportedSeries<Trajectory> series{.content = {}, .stream = stream_of(topic, file)};
  const CollectedTopic<FramedPose>& collected = streams_.poses.at(&topic);
  series.stream.left_out = collected.left_out;
  series.stream.left_out_reason = collected.left_out_reason;
  std::map<std::string, FrameRoute> routes;
  for (const auto* row : sorted_rows(collected, series.stream)) {
    auto route = routes.find(row->value.frame);
    if (route == routes.end()) {
      Expected<FrameRoute> found = route_from(row->value.frame, topic);
      if (!found) return found.error();
      series.stream.frame += (routes.empty() ? "" : "; ") + found->text;
      route = routes.emplace(row->value.frame, *std::move(found)).first;
    }
    Pose T_base_body = row->value.T_frame_body;
    if (!route->second.is_as_it_is) {
      const std::optional<Pose> T_base_frame =
          streams_.frames.lookup(route->second.links, row->stamp);
      if (!T_base_frame) {
        leave_out_row(series.stream, "has no transform at its time");
        continue;
      }
      T_base_body = *T_base_frame * T_base_body;
    }
    series.content.append(row->stamp, T_base_body);
  }
  series.stream.rows = series.content.size();
  return series;
}

Expected<ImportedSeries<Trajectory>> SeriesImporter::frame(const std::string& frame,
                                                           const std::string& file,
                                                           std::vector<Stamp> stamps) const {
  const std::string& base = selection_.base_frame;
  const auto links = streams_.frames.chain(base, frame);
  if (!links) {
    return Error{.message = base.empty() ? "no base frame is known for frame '" + frame + "'"
                                         : "no TF chain from '" + base + "' to '" + frame + "'",
                 .file = bag_.string(),
                 .hint = "choose --base-frame from the frames that 'pcavr inspect' lists"};
  }
  ImportedSeries<Trajectory> series{
      .content = {}, .stream = {.file = file, .topic = "TF", .frame = chain_text(base, *links)}};
  if (stamps.empty()) stamps = streams_.frames.stamps(*links);
  for (const Stamp stamp : stamps) {
    const std::optional<Pose> T_base_frame = streams_.frames.lookup(*links, stamp);
    if (T_base_frame)
      series.content.append(stamp, *T_base_frame);
    else
      leave_out_row(series.stream, "has no transform at its time");
  }
  series.stream.rows = series.content.size();
  return series;
}

Expected<ImportedSeries<std::vector<WrenchSample>>> SeriesImporter::wrench(
    const Trajectory& T_base_tool) const {
  const SurveyedTopic& topic = *selection_.wrench;
  ImportedSeries<std::vector<WrenchSample>> series{.content = {},
                                                   .stream = stream_of(topic, "wrench.csv")};
  series.stream.left_out = streams_.wrench.left_out;
  series.stream.left_out_reason = streams_.wrench.left_out_reason;
  const std::string& base = selection_.base_frame;
  const std::string given = frame_name(options_.topics.wrench_frame);
  const std::string frame = given.empty() && !topic.frames.empty() ? topic.frames.front() : given;
  const bool is_other = !base.empty() && !frame.empty() && frame != base;
  const auto links = is_other ? streams_.frames.chain(base, frame) : std::nullopt;
  const bool is_tools = !links && given == kToolAxes && !T_base_tool.empty();
  if (is_other && !links && !given.empty() && !is_tools) {
    return Error{.message = "no TF chain from '" + base + "' to '" + given + "'",
                 .file = bag_.string(),
                 .place = "--wrench-frame",
                 .hint = "choose a frame that TF connects with the base frame"};
  }
  if (options_.wrench_turn != 0.0 && !is_tools) {
    return Error{.message = "turns forces in the tool's axes, but these are not",
                 .file = bag_.string(),
                 .place = "--wrench-turn",
                 .hint = "give --wrench-frame tool, and the tool's poses"};
  }
  if (!links && frame != base && !frame.empty() && !is_tools) {
    observer_.on_warning(
        bag_.string() + ": " + topic.topic.name + ": forces are in frame '" + frame +
        "', which TF does not connect with the base frame; taken as they are; give "
        "--wrench-frame");
  }
  const bool has_tip = links && !T_base_tool.empty();
  series.stream.frame =
      is_tools ? "the tool's axes; torque about the sensor"
      : !links
          ? (frame.empty() ? "not stated" : frame) + (frame == base ? "" : ", taken as base axes")
          : "rotated: " + chain_text(base, *links) +
                (has_tip ? "; torque about the tip" : "; torque about the sensor");
  const auto rows = sorted_rows(streams_.wrench, series.stream);
  const FramedWrench tare = tare_of(rows, options_.tare);
  const Eigen::Quaterniond R_tool_sensor(
      Eigen::AngleAxisd(options_.wrench_turn, Eigen::Vector3d::UnitZ()));
  for (const auto* row : rows) {
    WrenchSample sample{row->stamp, row->value.force - tare.force, row->value.torque - tare.torque};
    if (is_tools) {
      const Eigen::Quaterniond R_base_tool =
          pose_near(T_base_tool, row->stamp).rotation() * R_tool_sensor;
      sample.force = R_base_tool * sample.force;
      sample.torque = R_base_tool * sample.torque;
    }
    if (links) {
      const std::optional<Pose> T_base_sensor = streams_.frames.lookup(*links, row->stamp);
      if (!T_base_sensor) {
        leave_out_row(series.stream, "has no transform at its time");
        continue;
      }
      sample.force = T_base_sensor->rotation() * sample.force;
      sample.torque = T_base_sensor->rotation() * sample.torque;
      if (has_tip) {
        const Eigen::Vector3d p_base_tip = pose_near(T_base_tool, row->stamp).translation();
        const Eigen::Vector3d arm = T_base_sensor->translation() - p_base_tip;
        sample.torque += arm.cross(sample.force);
      }
    }
    if (options_.invert_wrench) {
      sample.force = -sample.force;
      sample.torque = -sample.torque;
    }
    series.content.push_back(sample);
  }
  series.stream.rows = series.content.size();
  return series;
}

Expected<ImportedSeries<JointLog>> SeriesImporter::joints() const {
  const SurveyedTopic& topic = *selection_.joints;
  ImportedSeries<JointLog> series{.content = {}, .stream = stream_of(topic, "joints.csv")};
  ImportedStream& stream = series.stream;
  stream.left_out = streams_.joints.left_out;
  stream.left_out_reason = streams_.joints.left_out_reason;
  JointLog& log = series.content;
  log.joints = joints_to_import(topic);
  if (const auto checked = check_joint_names(log.joints, topic); !checked) return checked.error();
  std::vector<std::vector<double>> position, velocity, torque;
  for (const auto* row : sorted_rows(streams_.joints, stream)) {
    const RosJointState& state = row->value;
    std::vector<double> q = joint_values(state, state.position, log.joints);
    if (q.size() != log.joints.size() || q.empty()) {
      leave_out_row(stream, "has not the position of every joint");
      continue;
    }
    log.stamps.push_back(row->stamp);
    log.t.push_back(to_seconds(row->stamp - log.stamps.front()));
    position.push_back(std::move(q));
    velocity.push_back(joint_values(state, state.velocity, log.joints));
    torque.push_back(joint_values(state, state.effort, log.joints));
  }
  stream.rows = position.size();
  log.position = joint_matrix(position, log.joints.size());
  log.velocity = joint_matrix(velocity, log.joints.size());
  log.torque = joint_matrix(torque, log.joints.size());
  return series;
}

}  // namespace pcavr
