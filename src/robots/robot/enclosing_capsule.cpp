// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/robots/robot/robot_collision.hpp"

namespace pcavr {
namespace {

/// Iterations of the circle's centre; its radius is then within some 1 % of the least one.
constexpr int kCentreSteps = 200;
/// A larger radius makes a shorter capsule: radii tried, in units of the least one.
constexpr double kRadiusFactors[] = {1.0, 1.05, 1.1, 1.2, 1.4, 1.7};

double volume_of(const Capsule& capsule) {
  const double r = capsule.radius;
  return std::numbers::pi * r * r * ((capsule.b - capsule.a).norm() + 4.0 / 3.0 * r);
}

/// The centre of a small circle around the points' projections along `axis`, by steps towards the
/// farthest point [Badoiu & Clarkson 2003].
Eigen::Vector3d centre_across(const std::vector<Eigen::Vector3f>& points,
                              const Eigen::Vector3d& axis) {
  const auto across = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return p - axis * axis.dot(p);
  };
  Eigen::Vector3d centre = across(points.front().cast<double>());
  for (int step = 1; step <= kCentreSteps; ++step) {
    Eigen::Vector3d farthest = centre;
    double max_distance = 0.0;
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3d p = across(point.cast<double>());
      if ((p - centre).squaredNorm() <= max_distance) continue;
      max_distance = (p - centre).squaredNorm();
      farthest = p;
    }
    centre += (farthest - centre) / (step + 1.0);
  }
  return centre;
}

/// The shortest capsule of this radius around the line through `centre`; `radius` is at least each
/// point's distance to it.
Capsule capsule_of_radius(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& axis,
                          const Eigen::Vector3d& centre, double radius) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = point.cast<double>() - centre;
    const double along = axis.dot(p);
    const double across2 = (p - axis * along).squaredNorm();
    const double cap = std::sqrt(std::max(0.0, radius * radius - across2));
    low = std::min(low, along + cap);
    high = std::max(high, along - cap);
  }
  // One ball contains all where the caps' centres pass each other.
  if (low > high) low = high = 0.5 * (low + high);
  return {centre + axis * low, centre + axis * high, radius};
}

Capsule along(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d centre = centre_across(points, axis);
  double least = 0.0;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = point.cast<double>() - centre;
    least = std::max(least, (p - axis * axis.dot(p)).norm());
  }
  Capsule best = capsule_of_radius(points, axis, centre, least);
  for (const double factor : kRadiusFactors) {
    const Capsule capsule = capsule_of_radius(points, axis, centre, factor * least);
    if (volume_of(capsule) < volume_of(best)) best = capsule;
  }
  return best;
}

Eigen::Matrix3d axes_of_scatter(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& point : points) mean += point.cast<double>();
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = point.cast<double>() - mean;
    scatter += p * p.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
}

}  // namespace

std::optional<Capsule> enclosing_capsule(const std::vector<Eigen::Vector3f>& points) {
  if (points.empty()) return std::nullopt;
  const Eigen::Matrix3d axes = axes_of_scatter(points);
  Capsule best = along(points, Eigen::Vector3d::UnitX());
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0.0, 1.0, 0.0), Eigen::Vector3d(0.0, 0.0, 1.0),
        Eigen::Vector3d(axes.col(0)), Eigen::Vector3d(axes.col(1)), Eigen::Vector3d(axes.col(2))}) {
    const Capsule capsule = along(points, axis);
    if (volume_of(capsule) < volume_of(best)) best = capsule;
  }
  return best;
}

}  // namespace pcavr
