// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tool_shape.hpp"

#include <cmath>

namespace pcavr {
namespace {

constexpr double kApart = 0.03;  // [m] between two places of the tip: more than a cell's diagonal
constexpr int kPlaces = 3;       // that a cell has to be seen at
constexpr double kReach = 2.0;   // [m] from the tip: an arm is not longer

}  // namespace

void ToolShape::remember(const Eigen::Vector3d& p_tool, const Eigen::Vector3d& p_base_tip) {
  if (!(p_tool.norm() < kReach)) return;
  const Eigen::Vector3d cell = (p_tool / kEdge).array().floor();
  Sighting& sighting =
      cells_[{static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())}];
  if (sighting.places >= kPlaces) return;
  if (sighting.places > 0 && (p_base_tip - sighting.p_base_tip).norm() < kApart) return;
  ++sighting.places;
  sighting.p_base_tip = p_base_tip;
}

std::vector<Eigen::Vector3d> ToolShape::points() const {
  std::vector<Eigen::Vector3d> points;
  for (const auto& [cell, sighting] : cells_) {
    if (sighting.places < kPlaces) continue;
    points.push_back(kEdge * Eigen::Vector3d(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5));
  }
  return points;
}

}  // namespace pcavr
