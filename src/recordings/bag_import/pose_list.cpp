// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/pose_list.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"

#include "recordings/bag_import/pose_table.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// [m] Arms, boards and rooms are smaller, and no arm works within 20 mm of its base: coordinates
/// beyond it are in mm.
constexpr double kMaxMetres = 20.0;
constexpr double kMillimetre = 1e-3;

double typical_distance(const std::vector<ListedPose>& poses) {
  std::vector<double> distances;
  for (const ListedPose& pose : poses) distances.push_back(pose.pose.translation().norm());
  return median(std::move(distances));
}

void scale_lengths(double unit, std::vector<ListedPose>& poses) {
  for (ListedPose& listed : poses) {
    listed.pose = Pose(listed.pose.rotation(), unit * listed.pose.translation());
  }
}

/// Brings lengths to metres, and notes an assumption.
void to_metres(const PoseListOptions& options, PosesInFileUnit& found) {
  PoseList& list = found.list;
  const double distance = typical_distance(list.poses);
  double unit = 1.0;
  if (options.length_unit) {
    unit = *options.length_unit;
  } else if (!found.is_unit_stated && distance > kMaxMetres) {
    unit = kMillimetre;
    list.notes.push_back(
        fmt::format("lengths are taken as mm: they are {:.0f}, as metres more than "
                    "an arm or a room",
                    distance));
  }
  if (unit != 1.0) scale_lengths(unit, list.poses);
  list.format += unit == kMillimetre ? ", lengths in mm" : ", lengths in m";
}

}  // namespace

Expected<PoseList> read_pose_list(const fs::path& path, const PoseListOptions& options) {
  std::error_code code;
  const bool is_folder = fs::is_directory(path, code);
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const bool is_start = !is_folder && !path.has_extension() && !fs::exists(path, code) &&
                        fs::is_directory(parent, code);
  Expected<PosesInFileUnit> found =
      is_folder  ? read_pose_folder(path, "", options)
      : is_start ? read_pose_folder(parent, path.filename().string(), options)
                 : read_pose_table(path, options);
  if (!found) return found.error();
  if (found->list.poses.empty()) {
    return Error{.message = "has no poses", .file = path.string(), .hint = "give a table of poses"};
  }
  found->list.source = path.string();
  to_metres(options, *found);
  return std::move(found->list);
}

}  // namespace pcavr
