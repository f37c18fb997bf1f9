// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

struct TimedPose {
  Stamp stamp;
  Pose pose;
};

/// Poses of one frame in another, with strictly increasing stamps.
class Trajectory {
 public:
  Trajectory() = default;
  /// Throws ContractError unless the stamps are strictly increasing.
  explicit Trajectory(std::vector<TimedPose> poses);

  /// Throws ContractError unless the stamp is after the last one.
  void append(Stamp stamp, const Pose& pose);

  [[nodiscard]] const std::vector<TimedPose>& poses() const { return poses_; }
  [[nodiscard]] bool empty() const { return poses_.empty(); }
  [[nodiscard]] std::size_t size() const { return poses_.size(); }

  /// Interpolated at `stamp`; nullopt before the first and after the last stamp, and inside a gap
  /// longer than `max_gap`. O(log n).
  [[nodiscard]] std::optional<Pose> at(Stamp stamp,
                                       Duration max_gap = std::chrono::milliseconds(200)) const;

  /// Index of the pose nearest in time, if within `tolerance`. O(log n).
  [[nodiscard]] std::optional<std::size_t> nearest(Stamp stamp, Duration tolerance) const;

 private:
  std::vector<TimedPose> poses_;
};

}  // namespace pcavr
