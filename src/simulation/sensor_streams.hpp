// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/pose.hpp"

/// The sensors of sensors.hpp, sample by sample: for recordings and for a live plant.
namespace pcavr::simulation {

inline constexpr std::size_t kStepsPerSample = 2;  ///< of the plant's steps: 500 Hz
inline constexpr double kFrameRate = 30.0;         ///< [Hz] of the tracker

class ToolSensor {
 public:
  explicit ToolSensor(std::uint64_t seed);
  [[nodiscard]] Pose measure(const Eigen::Vector3d& p_base_tip);

 private:
  Random random_;
};

class WrenchSensor {
 public:
  explicit WrenchSensor(std::uint64_t seed);
  struct Sample {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  };
  /// Measures the means over one sample's time.
  [[nodiscard]] Sample measure(const Eigen::Vector3d& force, const Eigen::Vector3d& torque);

 private:
  Random random_;
  Eigen::Vector3d bias_;
};

/// The pose error of a marker tracker, frame by frame.
class TrackerError {
 public:
  TrackerError(std::uint64_t seed, std::size_t body);

  /// Error of a body at rest: a constant bias plus a little noise.
  [[nodiscard]] Vector6d at_rest();
  [[nodiscard]] Vector6d in_motion();

 private:
  /// Standard deviations per axis [m], [deg].
  [[nodiscard]] Vector6d noise_twist(double position, double degrees);
  void draw_bias();

  Random random_;
  Vector6d bias_ = Vector6d::Zero();
  bool was_moving_ = false;
};

/// Stds that the tracker states for its error.
inline constexpr double kRestingPositionStd = 2e-4;  ///< [m]
inline constexpr double kMovingPositionStd = 4e-4;   ///< [m]
inline constexpr double kRestingRotationStd = 1e-3;  ///< [rad]
inline constexpr double kMovingRotationStd = 2e-3;   ///< [rad]

/// Whether a tracker averages: the body has moved less than this over the last 0.1 s.
inline constexpr std::size_t kRestingSteps = 100;
[[nodiscard]] bool is_resting(const Eigen::Vector2d& p_before, double yaw_before,
                              const Eigen::Vector2d& p_now, double yaw_now);

}  // namespace pcavr::simulation
