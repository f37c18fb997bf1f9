// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/physics/turning/body_motion.hpp"

namespace pcavr {

/// Motion of the object's centre from its tracked poses, smoothed.
struct Twist {
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< [m/s] of the centre of mass
  double rate = 0.0;                                   ///< [rad/s]
};

class TrackedMotion {
  // Smoothed over a time in which the object moves so far, within limits.
  static constexpr double kTrackedTravel = 0.004;                                  // [m]
  static constexpr double kMinTrackedSmoothing = 0.1, kMaxTrackedSmoothing = 1.0;  // [s] half width

 public:
  explicit TrackedMotion(const BodyMotion& body) {
    double heading = 0.0;
    for (const TrackedPose& pose : body.tracked) {
      const Eigen::Vector3d centre = pose.T_base_object * body.model.centre_of_mass_object;
      const double now = heading_of(pose.T_base_object);
      heading += t_.empty() ? now : std::remainder(now - heading, 2.0 * std::numbers::pi);
      t_.push_back(pose.t);
      for (int k = 0; k < 2; ++k) centre_[static_cast<std::size_t>(k)].push_back(centre[k]);
      heading_.push_back(heading);
    }
  }

  /// Nothing where the poses do not cover the window.
  [[nodiscard]] std::optional<Twist> at(double t, double speed) const {
    if (t_.empty()) return std::nullopt;
    const double half_width = std::clamp(kTrackedTravel / std::max(speed, 1e-6),
                                         kMinTrackedSmoothing, kMaxTrackedSmoothing);
    const SmoothedSample x = smooth_at(t_, centre_[0], t, half_width);
    const SmoothedSample y = smooth_at(t_, centre_[1], t, half_width);
    const SmoothedSample a = smooth_at(t_, heading_, t, half_width);
    if (!x.is_valid || !y.is_valid || !a.is_valid) return std::nullopt;
    return Twist{{x.rate, y.rate}, a.rate};
  }

 private:
  std::vector<double> t_, heading_;
  std::array<std::vector<double>, 2> centre_;
};

}  // namespace pcavr
