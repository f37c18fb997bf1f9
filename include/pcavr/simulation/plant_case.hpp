// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/simulation/plant.hpp"

namespace pcavr {

/// The tool's task.
enum class ToolTask {
  none,
  push,    ///< an operator pushes each of two boxes at its centre until it slides and stops
  probe,   ///< for identification: presses, ten pushes to breakaway, a modulated slide
  press,   ///< along z at seven speeds [paper B]
  slot,    ///< into the slot of a block, along one wall and back along the other [paper B]
  hole,    ///< presses, pushes, then along z into an oblique hole, which slides and turns the block
           ///< [paper B]
  turn,    ///< off-centre pushes, so that the boxes turn
  paper,   ///< paper C's two boxes: a short probe of each, then the operator's push
  soft,    ///< along z at five speeds, 15 mm into something soft [paper B's ball]
  corner,  ///< pushes close to the corners of soft boxes, into which the tip goes by more than its
           ///< radius, and than the distance from the corner
  impact,  ///< slow presses, then impacts along z by a tip that flies freely while it hits
};

/// Bodies, tool and moves: the input of run_plant. The table's top is base z = 0.
struct PlantCase {
  std::vector<PlantBody> bodies;
  PlantTool tool;
  std::vector<ToolMove> moves;
  int substeps = PlantOptions().substeps;  ///< of the plant: impacts need finer ones
};

/// Options of ToolTask::push; other tasks ignore them.
struct PushOptions {
  static constexpr int kMaxBoxes = 20;  ///< as many as fit on the table with room to be pushed
  /// 1 to kMaxBoxes. Up to two stand apart, with sizes sampled from a wide range; more are small
  /// and stand in a grid.
  int boxes = 2;
  /// [s]: boxes are pushed one after another, back and forth, for at least this long; 0: each once.
  double duration = 0.0;
};

/// Variety beyond that of a laboratory.
enum class PlantVariety {
  plain,
  /// Worn supports, friction that depends on the load, and boxes that are pushed up to 12 degrees
  /// beside their faces' normals.
  wide
};

/// The same seed gives the same boxes (except for their positions) in push, probe, press and turn,
/// so that parameters identified in one case can be used in another.
[[nodiscard]] PlantCase make_plant_case(ToolTask task, std::uint64_t seed,
                                        const PushOptions& push = {},
                                        PlantVariety variety = PlantVariety::plain);

/// Gives the tool to a six-axis arm with its own dynamics [paper B's experiments]. The task has to
/// be press, slot or soft, whose bodies are within its reach.
void add_arm(PlantCase& plant, std::uint64_t seed);

}  // namespace pcavr
