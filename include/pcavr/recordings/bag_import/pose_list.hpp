// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// A pose that a program wrote: a row of a table, or a file of a folder.
struct ListedPose {
  Pose pose;
  std::optional<Stamp> stamp = {};
  int number = 0;         ///< of the view: stated, or else counted from 0 in the order of the rows
  std::string file = {};  ///< named in errors
  int line = 0;           ///< 1-based; 0 where the file is this one pose
};

struct PoseListOptions {
  bool skip_bad = false;    ///< leave out rows that can't be read, and count them
  bool is_w_first = false;  ///< quaternions are w, x, y, z
  /// [m] of which lengths are multiples; empty: the unit in the header, or by their size.
  std::optional<double> length_unit = {};

  friend bool operator==(const PoseListOptions&, const PoseListOptions&) = default;
};

/// The poses of one frame in another, in the order of the file, or of the files' numbers.
struct PoseList {
  std::string source;  ///< the file or folder, as given
  std::vector<ListedPose> poses = {};
  std::string format = {};  ///< how it was recognised: "31 files, matrices, lengths in mm"
  std::vector<std::string> notes = {};  ///< for the user: what was assumed or left out

  [[nodiscard]] bool has_stamps() const {
    return !poses.empty() && poses.front().stamp.has_value();
  }
};

/// Reads a table (CSV, TSV, TUM) or a folder with a file for each view, which may be named by what
/// its files' names begin with ("poses/robot" for poses/robot_0.txt, poses/robot_1.txt).
///
/// A table's columns are found by its header as open_csv_series finds them, and further: names that
/// all end alike (x_tool, y_tool), a rotation vector (rx, ry, rz), the number of the view (index)
/// in the place of a stamp. Without a header, by their count: position and quaternion x y z w (7),
/// position and rotation vector (6), the rows of a matrix (12 or 16), each of them after a stamp or
/// a number. A folder's files have such numbers, or YAML with a position and a quaternion.
/// Lengths without a unit are taken as mm where they are too large for metres, which a note states.
[[nodiscard]] Expected<PoseList> read_pose_list(const std::filesystem::path& path,
                                                const PoseListOptions& options = {});

}  // namespace pcavr
