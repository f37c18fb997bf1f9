// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/patch.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) noexcept {
  return a.x() * b.y() - a.y() * b.x();
}

/// The integral of |r| over the triangle (0, a, b), negative where it is clockwise [m^3]:
/// d^3/3 times the integral of sec^3 over the angle that the edge spans, d its distance.
double radius_integral(const Eigen::Vector2d& a, const Eigen::Vector2d& b) noexcept {
  const double edge = (b - a).norm();
  if (!(edge > 0.0)) return 0.0;
  const double distance = cross(a, b) / edge;
  if (distance == 0.0) return 0.0;
  const Eigen::Vector2d along = (b - a) / edge;
  const double from = a.dot(along);
  const double to = b.dot(along);
  const double turns = std::asinh(to / std::abs(distance)) - std::asinh(from / std::abs(distance));
  return distance * (to * b.norm() - from * a.norm() + distance * distance * turns) / 6.0;
}

}  // namespace

double mean_radius(std::span<const Eigen::Vector2d> polygon,
                   const Eigen::Vector2d& centre) noexcept {
  double radii = 0.0;
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - centre;
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - centre;
    radii += radius_integral(a, b);
    area += 0.5 * cross(a, b);
  }
  return area != 0.0 ? radii / area : 0.0;
}

double mean_radius_of_rectangle(double length, double width) noexcept {
  const double x = 0.5 * length;
  const double y = 0.5 * width;
  const std::array<Eigen::Vector2d, 4> corners{Eigen::Vector2d(-x, -y), Eigen::Vector2d(x, -y),
                                               Eigen::Vector2d(x, y), Eigen::Vector2d(-x, y)};
  return mean_radius(corners, Eigen::Vector2d::Zero());
}

std::optional<std::array<double, 3>> support_shares(const std::array<Eigen::Vector2d, 3>& points,
                                                    const Eigen::Vector2d& centre) noexcept {
  const double whole = cross(points[1] - points[0], points[2] - points[0]);
  std::array<double, 3> shares;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d& next = points[(i + 1) % 3];
    const Eigen::Vector2d& last = points[(i + 2) % 3];
    shares[i] = cross(next - centre, last - centre) / whole;
    if (!(shares[i] >= 0.0) || !std::isfinite(shares[i])) return std::nullopt;
  }
  return shares;
}

double mean_radius(const std::array<Eigen::Vector2d, 3>& points,
                   const std::array<double, 3>& shares, const Eigen::Vector2d& centre) noexcept {
  double radius = 0.0;
  for (std::size_t i = 0; i < 3; ++i) radius += shares[i] * (points[i] - centre).norm();
  return radius;
}

}  // namespace pcavr
