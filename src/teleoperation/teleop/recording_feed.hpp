// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "teleoperation/teleop/robot_site.hpp"

namespace pcavr {

/// Passes a recording's samples to the robot's site in the order in which they would have arrived:
/// tool and force at their stamps, tracked poses a latency later.
class RecordingFeed {
 public:
  /// Keeps a reference to `input`, which must outlive it.
  RecordingFeed(const TeleopInput& input, double tracking_latency);

  /// The samples that arrive by `now` [s] and were not passed on yet.
  void notify_change(double now, RobotSite& robot);

 private:
  const TeleopInput& input_;
  double tracking_latency_;  ///< [s]
  std::size_t next_tool_ = 0, next_force_ = 0;
  std::vector<std::size_t> next_tracked_;  ///< by object
};

}  // namespace pcavr
