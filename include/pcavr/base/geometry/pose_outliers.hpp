// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/geometry/tracked_pose.hpp"

namespace pcavr {

/// The number of poses of a tracked body that were rejected.
struct PoseOutliers {
  std::size_t count = 0;
  double first = 0.0;  ///< [s] stamp of the first one
};

/// Whether poses come one by one, and should not wait, or from a file.
enum class PoseSource { stream, file };

/// Rejects poses of a tracked body to which it can't have moved and from which it can't have
/// returned: a tracker that flips or takes something else for the body. A pose that is farther from
/// the one before than a body accelerates waits until a later one shows whether the body is there
/// or never left; all others pass at once. Where the body stays where it jumped to it is accepted
/// after a quarter of a second; of a stream after the next pose, where a push may have moved it so
/// far.
class PoseOutlierFilter {
 public:
  explicit PoseOutlierFilter(PoseSource source) : source_(source) {}

  /// The poses that are accepted now, in order of time: none, this one, or those that waited, too.
  /// Stamps ascend strictly.
  [[nodiscard]] std::vector<TrackedPose> add(const TrackedPose& pose);
  /// Ends the series: of the poses that still wait, the ones that are accepted. Those at an end are
  /// outliers where nothing confirms them.
  [[nodiscard]] std::vector<TrackedPose> finish();
  [[nodiscard]] const PoseOutliers& outliers() const { return outliers_; }

 private:
  [[nodiscard]] bool is_near(const std::optional<TrackedPose>& before, const TrackedPose& last,
                             const TrackedPose& pose) const;
  [[nodiscard]] bool has_stayed(double t) const;
  [[nodiscard]] std::vector<TrackedPose> take_waiting(const TrackedPose* returned);
  void accept(const TrackedPose& pose, std::vector<TrackedPose>& accepted);

  PoseSource source_;
  std::optional<TrackedPose> before_ = {}, last_ = {};  ///< the newest accepted poses
  std::vector<TrackedPose> waiting_;
  std::size_t stay_ = 0;  ///< of waiting_: from here on, each is near the one before
  PoseOutliers outliers_;
};

/// Removes the outliers of a whole series, also at its ends. Stamps ascend strictly.
PoseOutliers remove_pose_outliers(std::vector<TrackedPose>& poses);

/// "the pose jumps and returns, first at t = 12.345000 s": a reason, without the count.
[[nodiscard]] std::string describe(const PoseOutliers& outliers);

}  // namespace pcavr
