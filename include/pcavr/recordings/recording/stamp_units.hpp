// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// Properties of a stream that show the unit of its stamps.
struct StreamPace {
  enum class Kind { tool, force, joints, frames, tracking };
  std::string name;  ///< as in messages, such as "tool.csv"
  Kind kind = Kind::tool;
  std::size_t rows = 0;
  double interval = 0.0;             ///< [s] median
  double span = 0.0;                 ///< [s]
  std::optional<double> speed = {};  ///< [m/s] nearly the fastest; known of poses that move
};

[[nodiscard]] StreamPace pace_of(std::string name, StreamPace::Kind kind, const Trajectory& poses);

/// The tool, force, joints and frames of a recording. Streams of few rows are left out.
[[nodiscard]] std::vector<StreamPace> paces_of(const Recording& recording);

/// The unit in which stamps `interval` apart [s] would be those of a sensor: "milliseconds".
/// nullopt where none fits.
[[nodiscard]] std::optional<std::string> unit_of_interval(double interval);

/// Warnings about stamps that are probably not in seconds, with the evidence: a stream that lasts
/// 1000 times as long as another and is as much too slow for its kind, or a tool, its force and its
/// camera that are all too slow for a robot in motion. Slow sensors, a slow robot under fast
/// sensors, and a slow camera beside fast sensors are sound.
[[nodiscard]] std::vector<std::string> doubtful_stamp_units(const std::vector<StreamPace>& paces);

}  // namespace pcavr
