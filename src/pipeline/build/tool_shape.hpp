// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "pcavr/pipeline/perception_options.hpp"

namespace pcavr {

/// The shape that moves with a tool's tip: grid cells of the tool frame that contained a depth
/// reading at several positions of the tip. A static wall falls into one cell at a single position
/// only.
class ToolShape {
 public:
  static constexpr double kEdge = 0.01;  ///< of a cell [m]: about the thinnest shaft

  explicit ToolShape(const MaskOptions& options = {}) : options_(options) {}

  /// Adds a reading at `p_tool` [m] while the tip was at `p_base_tip` [m].
  void add(const Eigen::Vector3d& p_tool, const Eigen::Vector3d& p_base_tip);

  /// The centres [m], tool frame, of the cells that move with the tip.
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;

 private:
  struct Cell {
    int tip_positions = 0;       ///< distinct, with a reading in this cell
    Eigen::Vector3d p_base_tip;  ///< the last of them
  };
  MaskOptions options_;
  std::map<std::array<int, 3>, Cell> cells_;
};

}  // namespace pcavr
