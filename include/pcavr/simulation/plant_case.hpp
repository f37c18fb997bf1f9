// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/simulation/plant.hpp"

namespace pcavr {

/// What the tool does among the bodies.
enum class ToolTask {
  none,
  push,   ///< an operator pushes each of two boxes through its centre until it slides and stops
  probe,  ///< what identification asks for: presses, ten pushes to breakaway, a modulated slide
  press,  ///< along z at seven speeds [paper B]
  slot,   ///< into the slot of a block, along one wall and back along the other [paper B]
  turn,   ///< beside the centre, so that the boxes turn
  paper,  ///< paper C's two boxes: a short probe of each, then the operator's push
};

/// Who is there and what is done, ready for run_plant. The table's top is base z = 0.
struct PlantCase {
  std::vector<PlantBody> bodies;
  PlantTool tool;
  std::vector<ToolMove> moves;
};

/// What ToolTask::push can be asked for; the other tasks take neither.
struct PushOptions {
  static constexpr int kMaxBoxes = 20;  ///< the table has room for so many, each to be pushed
  /// 1 to kMaxBoxes. Up to two stand apart and are drawn wide; more are small and stand in a grid.
  int boxes = 2;
  /// [s]: boxes are pushed one after another, to and fro, for at least as long; 0: each once.
  double duration = 0.0;
};

/// The same seed gives the same boxes (but for where they stand) in push, probe, press and turn,
/// so that what one case tells of them can be used in another.
[[nodiscard]] PlantCase make_plant_case(ToolTask task, std::uint64_t seed,
                                        const PushOptions& push = {});

}  // namespace pcavr
