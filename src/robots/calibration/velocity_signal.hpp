// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/calibration/pose_stream.hpp"

namespace pcavr {

enum class Velocity { angular, linear };

/// A stream's velocity over a window about an instant.
class VelocitySignal {
 public:
  /// `slow_interval` [s] of the slower of the two streams.
  VelocitySignal(const PoseStream& stream, Velocity kind, double half_window, double slow_interval);

  /// Nothing where the window reaches into a gap, or out of the stream.
  [[nodiscard]] std::optional<Eigen::Vector3d> at(double t) const;
  [[nodiscard]] double begin() const { return stream_.poses.poses().front().stamp.seconds(); }
  [[nodiscard]] double end() const { return stream_.poses.poses().back().stamp.seconds(); }
  [[nodiscard]] double half_window() const { return half_window_; }

 private:
  const PoseStream& stream_;
  Velocity kind_;
  double half_window_;
  Duration max_gap_;
};

/// b's velocities, at instants of its own clock.
struct VelocitySamples {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> b;
};

/// `interval` [s] of the faster of the two streams.
[[nodiscard]] VelocitySamples samples_of(const VelocitySignal& b, double interval);

/// The turn R that minimises the sum of |a - R b|^2, of the sum of a b' [Kabsch 1976].
[[nodiscard]] Eigen::Matrix3d turn_of(const Eigen::Matrix3d& sum);

/// [s] of half the window of a velocity, of streams whose slower one has this interval.
[[nodiscard]] double velocity_half_window(double slow_interval);

/// [s] over which a stream with this interval is interpolated.
[[nodiscard]] double max_interpolated_gap(double interval);

}  // namespace pcavr
