// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/box_grid.hpp"

namespace pcavr::simulation {
namespace {

constexpr int kColumns = 4;
// A column's width: a box (0.1 m), a push (0.03 m), a tip with its standoff on both sides
// (2 x 0.045 m), and 3 cm of clearance.
constexpr double kColumnPitch = 0.25;  ///< along base y [m]
constexpr double kRowPitch = 0.125;    ///< along base x [m]
constexpr double kCentreX = 0.51;      ///< [m]; the base tag lies in front of the nearest row
constexpr double kMaxYaw = 0.08;       ///< [rad]; rows stay 2 cm apart

}  // namespace

Eigen::Vector3d grid_half_extents(Random& random) {
  const double x = random.uniform(0.042, 0.048);
  const double y = random.uniform(0.042, 0.048);
  return {x, y, random.uniform(0.03, 0.05)};
}

Pose grid_pose(int number, int count, double half_height, Random& random) {
  const int rows = (count + kColumns - 1) / kColumns;
  const double row = number / kColumns - 0.5 * (rows - 1);
  const double column = number % kColumns - 0.5 * (kColumns - 1);
  const double yaw = random.uniform(-kMaxYaw, kMaxYaw);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
          {kCentreX + kRowPitch * row, kColumnPitch * column, half_height}};
}

}  // namespace pcavr::simulation
