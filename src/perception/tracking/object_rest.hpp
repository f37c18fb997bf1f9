// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

namespace pcavr::tracking {

/// One frame's measurement of an object's pose.
struct PoseMeasurement {
  Pose T_base_object;
  Matrix6d information = Matrix6d::Zero();  ///< of [v; w] in object axes; may be singular
  /// Contribution of the camera pose's uncertainty, of [v; w] in object axes.
  Matrix6d camera_covariance = Matrix6d::Zero();
};

/// Stationarity detector: decides whether an object is at rest, and averages its measurements while
/// it is.
///
/// Two change-detection tests against the average, each by the squared Mahalanobis distance: of one
/// measurement (twice in a row, so that one outlier does not reset the average), and of the mean of
/// the most recent ones (so that slow sliding is detected instead of averaged). The variance factor
/// that scales both is estimated from differences of consecutive measurements, which slow motion
/// does not inflate.
class RestFilter {
 public:
  struct Estimate {
    Pose T_base_object;
    Matrix6d covariance = Matrix6d::Zero();
    bool is_at_rest = false;
  };

  explicit RestFilter(const RestOptions& options = {}) : options_(options) {}

  Estimate add(const PoseMeasurement& measurement);

  /// The average; nothing while the object moves.
  [[nodiscard]] std::optional<Estimate> at_rest() const;

 private:
  struct Average {
    Pose T_base_object;
    Matrix6d information = Matrix6d::Zero();
    int count = 0;
    void add(const PoseMeasurement& measurement, int max_averaged);
  };

  [[nodiscard]] Matrix6d floor_covariance() const;
  [[nodiscard]] Average average_of_all() const;
  [[nodiscard]] bool has_jumped(const PoseMeasurement& measurement) const;
  [[nodiscard]] bool has_drifted() const;
  void update_variance_factor(const PoseMeasurement& measurement);
  void reset();

  RestOptions options_;
  Average older_;  ///< all but the recent ones
  std::deque<PoseMeasurement> recent_;
  std::optional<PoseMeasurement> last_;
  double variance_factor_ = 1.0;  ///< observed variance of the measurements over the stated one
  int variance_count_ = 0;
  int jumps_ = 0;  ///< consecutive
};

}  // namespace pcavr::tracking
