// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "pcavr/geometry/pose.hpp"

namespace pcavr::tracking {

/// One frame's say on where an object is.
struct PoseMeasurement {
  Pose T_base_object;
  Matrix6d information = Matrix6d::Zero();  ///< of [v; w] in object axes; may be singular
  /// What the camera's own pose adds [of [v; w] in object axes].
  Matrix6d camera_covariance = Matrix6d::Zero();
};

/// Decides whether an object rests, and averages its measurements while it does.
///
/// Two tests against the average, each by the squared Mahalanobis distance: of one measurement
/// (twice in a row, so that one bad frame does not end a rest), and of the mean of the newest few
/// (so that slow sliding is found and not averaged away). The scatter of the measurements, which
/// scales both, is learnt from differences of consecutive ones, which slow motion does not inflate.
class RestFilter {
 public:
  struct Estimate {
    Pose T_base_object;
    Matrix6d covariance = Matrix6d::Zero();
    bool is_at_rest = false;
  };

  Estimate add(const PoseMeasurement& measurement);

  /// The average; nothing while the object moves.
  [[nodiscard]] std::optional<Estimate> at_rest() const;

 private:
  struct Average {
    Pose T_base_object;
    Matrix6d information = Matrix6d::Zero();
    int count = 0;
    void add(const PoseMeasurement& measurement);
  };

  [[nodiscard]] Average everything() const;
  [[nodiscard]] bool has_jumped(const PoseMeasurement& measurement) const;
  [[nodiscard]] bool has_crept() const;
  void learn_scatter(const PoseMeasurement& measurement);
  void start_anew();

  Average old_;  ///< all but the newest
  std::deque<PoseMeasurement> newest_;
  std::optional<PoseMeasurement> last_;
  double scatter_ = 1.0;  ///< variance of the measurements over what they claim
  int scatter_count_ = 0;
  int jumps_ = 0;  ///< in a row
};

}  // namespace pcavr::tracking
