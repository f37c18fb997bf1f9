// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "pcavr/pipeline/calibrate.hpp"

#include "pose_input.hpp"

namespace pcavr {
namespace {

/// The pose in frames whose given axis points the other way: of a left-handed frame a right-handed
/// one.
Pose with_axis_reversed(const Pose& pose, int axis) {
  Eigen::Vector3d p = pose.translation();
  p[axis] = -p[axis];
  // A reflection keeps the part of a rotation's axis along its normal, and reverses the others.
  Eigen::Vector3d v = -pose.rotation().vec();
  v[axis] = -v[axis];
  return Pose(Eigen::Quaterniond(pose.rotation().w(), v.x(), v.y(), v.z()), p);
}

PoseStream stream_of(const PoseList& list) {
  std::vector<TimedPose> rows;
  for (const ListedPose& listed : list.poses) rows.push_back({*listed.stamp, listed.pose});
  return clean_stream(list.source, std::move(rows));
}

Error no_stamps(const PoseList& list) {
  return {.message = "has no stamps, of which the clocks' offset is made",
          .file = list.source,
          .hint = "give a table with a column of times, such as t, x, y, z, qx, qy, qz, qw"};
}

std::string step_note(const ComparedClocks& found) {
  const ClockStep& step = *found.clock.step;
  return fmt::format(
      "the clocks step against each other by {:.1f} +- {:.1f} ms at t = {} s of {}: "
      "the clock of {} was set back then, or that of {} ahead",
      1e3 * std::abs(step.size), 1e3 * step.std, format_stamp(Stamp::from_seconds(step.at), 2),
      found.b.name, step.size > 0.0 ? found.b.name : found.a.name,
      step.size > 0.0 ? found.a.name : found.b.name);
}

std::string drift_note(const ComparedClocks& found) {
  return fmt::format(
      "no two clocks drift by {:.2g} %: one was set, or the stamps of {} or {} are counted rows of "
      "another rate; don't use this offset",
      1e2 * std::abs(*found.clock.drift), found.a.name, found.b.name);
}

Expected<ComparedClocks> compare(const PoseList& a, const PoseList& b,
                                 const ClockOffsetOptions& options) {
  if (!a.has_stamps()) return no_stamps(a);
  if (!b.has_stamps()) return no_stamps(b);
  ComparedClocks found{.a = stream_of(a), .b = stream_of(b), .clock = {}};
  found.formats = {a.format, b.format};
  found.notes = a.notes;
  found.notes.insert(found.notes.end(), b.notes.begin(), b.notes.end());
  for (const PoseStream* stream : {&found.a, &found.b}) {
    found.notes.insert(found.notes.end(), stream->notes.begin(), stream->notes.end());
  }
  found.clock = estimate_clock_offset(found.a, found.b, options);
  if (found.clock.step) found.notes.push_back(step_note(found));
  if (std::abs(found.clock.drift.value_or(0.0)) > kMaxClockDrift) {
    found.notes.push_back(drift_note(found));
  }
  return found;
}

Expected<PairedPoses> pair_by_number(const PoseList& robot, const PoseList& camera) {
  std::map<int, const ListedPose*> boards;
  for (const ListedPose& listed : camera.poses) {
    const auto [before, is_new] = boards.emplace(listed.number, &listed);
    if (is_new) continue;
    return Error{.message = fmt::format("view {} is there twice", listed.number),
                 .file = listed.file,
                 .line = listed.line,
                 .hint = "number each view once"};
  }
  PairedPoses paired{.formats = {robot.format, camera.format}};
  std::vector<std::string> alone;
  for (const ListedPose& listed : robot.poses) {
    const auto found = boards.find(listed.number);
    if (found == boards.end()) {
      alone.push_back(fmt::format("{}", listed.number));
      continue;
    }
    paired.views.push_back(
        {fmt::format("view {}", listed.number), listed.pose, found->second->pose});
    boards.erase(found);
  }
  for (const auto& entry : boards) alone.push_back(fmt::format("{}", entry.first));
  if (paired.views.empty()) {
    return Error{.message = "no view has the number of one of " + robot.source,
                 .file = camera.source,
                 .hint = "number the views of both alike, or give stamps to both"};
  }
  if (!alone.empty()) {
    std::string numbers;
    for (const std::string& number : alone) numbers += (numbers.empty() ? "" : ", ") + number;
    paired.notes.push_back(fmt::format("only one of both has view{} {}: left out",
                                       alone.size() > 1 ? "s" : "", numbers));
  }
  return paired;
}

Expected<PairedPoses> pair_by_stamps(const PoseList& robot, const PoseList& camera) {
  const Expected<ComparedClocks> clocks = compare(robot, camera, {});
  if (!clocks) return clocks.error();
  if (!clocks->clock.is_observable) {
    return Error{.message = "the clocks' offset is not observable: " + clocks->clock.reason,
                 .file = camera.source,
                 .hint = "move both with turns about several axes, or number the views"};
  }
  PairedPoses paired{.views = paired_views(clocks->a, clocks->b, clocks->clock),
                     .clock = clocks->clock,
                     .formats = clocks->formats,
                     .notes = clocks->notes};
  return paired;
}

}  // namespace

Expected<PoseList> read_pose_input(const PoseInput& input) {
  Expected<PoseList> list = read_pose_list(input.path, input.reading);
  if (!list) return list;
  for (ListedPose& listed : list->poses) {
    if (input.mirrored_axis) listed.pose = with_axis_reversed(listed.pose, *input.mirrored_axis);
    if (input.is_inverted) listed.pose = listed.pose.inverse();
  }
  for (std::string& note : list->notes) note = input.path + ": " + note;
  return list;
}

Expected<PairedPoses> read_paired_poses(const PoseInput& robot, const PoseInput& camera) {
  const Expected<PoseList> arm = read_pose_input(robot), board = read_pose_input(camera);
  if (!arm) return arm.error();
  if (!board) return board.error();
  if (arm->has_stamps() && board->has_stamps()) return pair_by_stamps(*arm, *board);
  Expected<PairedPoses> paired = pair_by_number(*arm, *board);
  if (!paired) return paired;
  paired->notes.insert(paired->notes.begin(), board->notes.begin(), board->notes.end());
  paired->notes.insert(paired->notes.begin(), arm->notes.begin(), arm->notes.end());
  return paired;
}

Expected<ComparedClocks> compare_pose_clocks(const PoseInput& a, const PoseInput& b,
                                             const ClockOffsetOptions& options) {
  const Expected<PoseList> first = read_pose_input(a), second = read_pose_input(b);
  if (!first) return first.error();
  if (!second) return second.error();
  return compare(*first, *second, options);
}

}  // namespace pcavr
