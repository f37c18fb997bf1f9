// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <LinearMath/btAlignedAllocator.h>
#include <gtest/gtest.h>

#include "pcavr/physics/prediction/predictor.hpp"

#include "prediction/worlds.hpp"
#include "support/heap_counter.hpp"

namespace pcavr {
namespace {

Eigen::Vector3d tip_at(double t) {
  return test::touching_tip(0.02) + Eigen::Vector3d(0.06 * t, 0.0, 0.0);
}

/// Bullet uses malloc, which the counter of operator new does not count.
void* count_bullet_allocations(std::size_t size) {
  ++heap_allocations;
  return std::malloc(size);
}

TEST(Allocation, StepsAndCorrectionsDoNotAllocate) {
  WorldModel model = test::row_of_boxes(3, 0.005);
  model.static_mesh_base = test::wall_at(0.0875 + 2 * 0.18 + 0.03, 0.0005);
  Predictor predictor(PredictedWorld::create(std::move(model)).value(), 0.0, tip_at(0.0));
  Correction correction;
  correction.T_base_object = test::standing_at(0.02, 0.0, 0.01);
  correction.physics = test::foam_physics();
  btAlignedAllocSetCustom(count_bullet_allocations, std::free);
  const long before = heap_allocations;
  for (int i = 1; i <= 1500; ++i) {  // through both neighbours and against the wall
    predictor.step(tip_at(0.001 * i));
    if (i % 300 != 0) continue;
    correction.t = predictor.now() - 0.2;
    ASSERT_TRUE(predictor.correct(correction));
  }
  const long during = heap_allocations - before;
  btAlignedAllocSetCustom(nullptr, nullptr);
  EXPECT_EQ(during, 0);
  EXPECT_GT(predictor.world().state()[2].planar.position.x(), 0.37);
}

}  // namespace
}  // namespace pcavr
