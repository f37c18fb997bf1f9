// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <utility>

#include <fmt/format.h>

#include "pcavr/pipeline/calibrate_pictures.hpp"

namespace pcavr {
namespace {

std::string numbers_text(const std::vector<int>& numbers) {
  std::string text;
  for (const int number : numbers) text += fmt::format("{}{}", text.empty() ? "" : ", ", number);
  return text;
}

}  // namespace

Expected<PairedPictures> read_paired_pictures(const PoseInput& robot, const std::string& pictures,
                                              const Board& board, Parallelism parallelism) {
  Expected<PoseList> poses = read_pose_list(robot.path, robot.reading);
  if (!poses) return poses.error();
  const Expected<BoardViews> found = read_board_views(pictures, board, parallelism);
  if (!found) return found.error();
  std::map<int, Pose> by_number;
  for (const ListedPose& listed : poses->poses) {
    const Pose pose = robot.is_inverted ? listed.pose.inverse() : listed.pose;
    if (by_number.emplace(listed.number, pose).second) continue;
    return Error{.message = fmt::format("view {} is there twice", listed.number),
                 .file = listed.file,
                 .line = listed.line,
                 .hint = "number each view once"};
  }
  PairedPictures paired{.width = found->width,
                        .height = found->height,
                        .format = poses->format,
                        .notes = poses->notes};
  paired.notes.insert(paired.notes.end(), found->notes.begin(), found->notes.end());
  std::vector<int> alone;
  for (const BoardView& view : found->views) {
    const auto pose = by_number.find(view.number);
    if (pose == by_number.end()) {
      alone.push_back(view.number);
      continue;
    }
    paired.views.push_back({view, pose->second});
  }
  if (paired.views.empty()) {
    return Error{.message = "no picture of the board has the number of a pose of " + robot.path,
                 .file = pictures,
                 .hint = "number pictures and poses alike: color_7.png and pose_7.txt"};
  }
  if (!alone.empty()) {
    paired.notes.push_back("left out: the arm has no pose of picture " + numbers_text(alone));
  }
  return paired;
}

}  // namespace pcavr
