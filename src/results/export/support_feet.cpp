// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/support_feet.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/friction/point_push.hpp"

namespace pcavr::detail {
namespace {

constexpr int kDirections = 24;       // every 15 degrees: a quartic has no finer structure
constexpr int kTwists = 200;          // over the sphere of twists
constexpr double kMinFriction = 0.1;  // of a foot, over the mean: none may be negative

/// The force that keeps the body sliding without rotation, averaged over the directions.
double mean_sliding_force(const LimitSurface& surface) {
  double sum = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kDirections;
    const Eigen::Vector3d twist(std::cos(angle), std::sin(angle), 0.0);
    sum += sliding_load(surface, twist).dot(twist);
  }
  return sum / kDirections;
}

/// The point about which forces of pure translation have no moment [m].
Eigen::Vector2d friction_centre(const LimitSurface& surface) {
  const Eigen::Vector3d along_x = sliding_load(surface, Eigen::Vector3d::UnitX());
  const Eigen::Vector3d along_y = sliding_load(surface, Eigen::Vector3d::UnitY());
  return {along_y.z() / along_y.y(), -along_x.z() / along_x.x()};
}

Eigen::Vector3d load_of(const std::vector<PlanarFoot>& feet, const Eigen::Vector3d& twist) {
  Eigen::Vector3d load = Eigen::Vector3d::Zero();
  for (const PlanarFoot& foot : feet) {
    const Eigen::Vector2d velocity = velocity_of(foot.position, twist);
    if (velocity.norm() < 1e-12) continue;  // the foot is the centre of rotation
    load += wrench_of(foot.friction * velocity.normalized(), foot.position);
  }
  return load / static_cast<double>(feet.size());
}

}  // namespace

double turning_radius_of(const LimitSurface& surface) {
  return sliding_load(surface, Eigen::Vector3d::UnitZ()).z() / mean_sliding_force(surface);
}

double turning_radius_of(const std::vector<PlanarFoot>& feet) {
  return load_of(feet, Eigen::Vector3d::UnitZ()).z();
}

std::vector<PlanarFoot> fit_feet(const LimitSurface& surface) {
  const double radius = turning_radius_of(surface);
  std::vector<PlanarFoot> feet(kFeet);
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (int k = 0; k < kFeet; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kFeet;
    Eigen::Vector2d& p = feet[static_cast<std::size_t>(k)].position;
    p = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    second += p * p.transpose() / kFeet;
  }
  const Eigen::Vector2d slope = second.ldlt().solve(friction_centre(surface));
  for (PlanarFoot& foot : feet) {
    foot.friction = std::max(1.0 + slope.dot(foot.position), kMinFriction);
  }
  return feet;
}

FeetError error_of(const std::vector<PlanarFoot>& feet, const LimitSurface& surface) {
  const double radius = turning_radius_of(surface);
  const double force = mean_sliding_force(surface);
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  FeetError error;
  for (int i = 0; i < kTwists; ++i) {  // a Fibonacci spiral over the sphere of twists
    const double turning = 1.0 - (2.0 * i + 1.0) / kTwists;
    const double moving = std::sqrt(1.0 - turning * turning);
    const Eigen::Vector3d twist(moving * std::cos(golden * i), moving * std::sin(golden * i),
                                turning / radius);
    Eigen::Vector3d difference = load_of(feet, twist) - sliding_load(surface, twist) / force;
    difference.z() /= radius;
    error.rms += difference.squaredNorm() / kTwists;
    error.max = std::max(error.max, difference.norm());
  }
  error.rms = std::sqrt(error.rms);
  return error;
}

}  // namespace pcavr::detail
