// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tool_shape.hpp"

#include <cmath>

namespace pcavr {

void ToolShape::add(const Eigen::Vector3d& p_tool, const Eigen::Vector3d& p_base_tip) {
  if (!(p_tool.norm() < options_.max_tip_distance)) return;
  const Eigen::Vector3d index = (p_tool / kEdge).array().floor();
  Cell& cell = cells_[{static_cast<int>(index.x()), static_cast<int>(index.y()),
                       static_cast<int>(index.z())}];
  if (cell.tip_positions >= options_.min_tip_positions) return;
  if (cell.tip_positions > 0 && (p_base_tip - cell.p_base_tip).norm() < options_.min_tip_motion) {
    return;
  }
  ++cell.tip_positions;
  cell.p_base_tip = p_base_tip;
}

std::vector<Eigen::Vector3d> ToolShape::points() const {
  std::vector<Eigen::Vector3d> points;
  for (const auto& [index, cell] : cells_) {
    if (cell.tip_positions < options_.min_tip_positions) continue;
    points.push_back(kEdge * Eigen::Vector3d(index[0] + 0.5, index[1] + 0.5, index[2] + 0.5));
  }
  return points;
}

}  // namespace pcavr
