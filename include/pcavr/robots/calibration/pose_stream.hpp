// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"

namespace pcavr {

/// Poses of one frame in another over time, and what was wrong with them.
struct PoseStream {
  std::string name;  ///< as messages name it
  Trajectory poses = {};
  std::size_t out_of_order = 0;  ///< rows with a stamp before that of the row above
  std::size_t repeated = 0;      ///< rows with the stamp of another row, or that repeat its pose
  std::size_t wild = 0;          ///< single poses far from those before and after
  std::vector<std::string> notes = {};  ///< for the user: one for each of these

  /// [s] median of the time between two poses.
  [[nodiscard]] double interval() const;
};

/// Sorts the rows, leaves out repeated and wild ones, and says so.
[[nodiscard]] PoseStream clean_stream(std::string name, std::vector<TimedPose> rows);

}  // namespace pcavr
