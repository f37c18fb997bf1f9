// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// What goes along with a tool's tip: cells of the tool frame that held a reading while the tip was
/// at several places. A wall behind the tool holds one at a single place only.
class ToolShape {
 public:
  static constexpr double kEdge = 0.01;  ///< of a cell [m]: a shaft is hardly thinner

  /// A reading at `p_tool` [m] while the tip was at `p_base_tip` [m].
  void remember(const Eigen::Vector3d& p_tool, const Eigen::Vector3d& p_base_tip);

  /// The centres [m], tool frame, of the cells that went along.
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;

 private:
  struct Sighting {
    int places = 0;
    Eigen::Vector3d p_base_tip;  ///< at the last of them
  };
  std::map<std::array<int, 3>, Sighting> cells_;
};

}  // namespace pcavr
