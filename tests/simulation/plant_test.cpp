// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/plant.hpp"

#include <gtest/gtest.h>

#include "pcavr/simulation/plant_case.hpp"

namespace pcavr {
namespace {

TEST(Plant, TheSameSeedGivesTheSameRun) {
  const PlantCase plant = make_plant_case(ToolTask::paper, 3);
  const PlantRun a = run_plant(plant.bodies, plant.tool, plant.moves);
  const PlantRun b = run_plant(plant.bodies, plant.tool, plant.moves);
  EXPECT_EQ(a.p_base_tip, b.p_base_tip);
  EXPECT_EQ(a.force_base, b.force_base);
}

}  // namespace
}  // namespace pcavr
