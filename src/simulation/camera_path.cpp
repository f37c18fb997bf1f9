// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/camera_path.hpp"

#include <cmath>
#include <numbers>

#include "pcavr/base/core/random.hpp"

#include "simulation/box_grid.hpp"

namespace pcavr::simulation {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// A grid of boxes is viewed from higher up, so that no box occludes the next one's tags.
constexpr double kGridElevation = 22.0 * kDegree;
constexpr double kGridCentre = 0.645;  ///< base x halfway between the farthest box and the tag [m]

/// The pose of a camera at `p_base` that looks at `target` without roll.
Pose look_at(const Eigen::Vector3d& p_base, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - p_base).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R_base_camera;
  R_base_camera << right, forward.cross(right), forward;
  return {Eigen::Quaterniond(R_base_camera), p_base};
}

}  // namespace

double CameraPath::Sinusoid::at(double t) const {
  return mean + amplitude * std::sin(2.0 * std::numbers::pi * t / period + phase);
}

CameraPath::CameraPath(const SimulationCase& simulation, std::uint64_t seed)
    : is_fixed_(simulation.is_camera_fixed) {
  Random random = Random(seed).fork(4);
  const auto sinusoid = [&](double mean, double amplitude, double min_period, double max_period) {
    return Sinusoid{.mean = mean,
                    .amplitude = amplitude,
                    .period = random.uniform(min_period, max_period),
                    .phase = random.uniform(0.0, 2.0 * std::numbers::pi)};
  };
  if (is_fixed_) {
    azimuth_.mean = random.uniform(-6.0, 6.0) * kDegree;
    elevation_.mean = random.uniform(34.0, 38.0) * kDegree;
    distance_.mean = random.uniform(1.02, 1.08);
    target_[0].mean = 0.68;
    target_[2].mean = 0.03;
    if (needs_grid(simulation.movable_boxes)) {
      elevation_.mean += kGridElevation;
      distance_.mean += 0.07;
      target_[0].mean = kGridCentre;
    }
    return;
  }
  // A hand moves a camera at up to 0.3 m/s and 20 degrees/s: periods of several seconds.
  azimuth_ = sinusoid(0.0, 26.0 * kDegree, 6.5, 8.0);
  // The camera looks down at the table; if there is a tag on the wall too, high enough to see it.
  const bool sees_wall = simulation.base_tags >= 2;
  elevation_ = sinusoid((sees_wall ? 27.0 : 36.0) * kDegree, 5.0 * kDegree, 4.0, 6.0);
  distance_ = sinusoid(sees_wall ? 1.15 : 0.92, 0.10, 5.0, 7.0);
  if (needs_grid(simulation.movable_boxes)) {
    elevation_.mean += kGridElevation;
    distance_.mean += 0.16;
  }
  target_ = {sinusoid(0.66, 0.06, 4.5, 6.5), sinusoid(0.02, 0.10, 4.0, 6.0),
             sinusoid(0.03, 0.02, 3.0, 5.0)};
  for (std::size_t i = 0; i < 6; ++i) {
    tremor_[i] =
        i < 3 ? sinusoid(0.0, 0.0015, 0.25, 0.6) : sinusoid(0.0, 0.15 * kDegree, 0.25, 0.6);
  }
}

Pose CameraPath::T_base_camera(double t) const {
  const Eigen::Vector3d target(target_[0].at(t), target_[1].at(t), target_[2].at(t));
  const double azimuth = azimuth_.at(t);
  const double elevation = elevation_.at(t);
  const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  const Pose steady = look_at(target + distance_.at(t) * direction, target);
  if (is_fixed_) return steady;
  Vector6d twist;
  for (Eigen::Index i = 0; i < 6; ++i) twist[i] = tremor_[static_cast<std::size_t>(i)].at(t);
  return steady * Pose::exp(twist);
}

}  // namespace pcavr::simulation
