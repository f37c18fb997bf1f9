// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <LinearMath/btAlignedAllocator.h>
#include <gtest/gtest.h>

#include "haptics/closed_paths.hpp"
#include "haptics/scanned_bumps.hpp"
#include "haptics/tabletop.hpp"
#include "support/heap_counter.hpp"

namespace pcavr {
namespace {

using test::kCycle;

/// Bullet calls malloc, which the counter of operator new does not count.
void* count_bullet_allocation(std::size_t size) {
  ++heap_allocations;
  return std::malloc(size);
}

TEST(HapticTool, IsDeterministicAndDoesNotAllocate) {
  const test::ScannedBumps bumps(200, 0.0003, 2);
  HapticTool first(bumps.mesh(), {}, {});
  HapticTool second(bumps.mesh(), {}, {});
  const test::PressAndSlide hand(4);
  ASSERT_TRUE(first.reset(hand(1.85) + Eigen::Vector3d(0.0, 0.0, 0.01)));
  ASSERT_TRUE(second.reset(hand(1.85) + Eigen::Vector3d(0.0, 0.0, 0.01)));
  const long before = heap_allocations;
  bool is_same = true;
  long contacts = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d tip = hand(1.85 + i * kCycle);
    const HapticState a = first.step(tip, kCycle);
    const HapticState b = second.step(tip, kCycle);
    is_same &= a.proxy == b.proxy && a.force == b.force;
    contacts += a.is_in_contact ? 1 : 0;
  }
  EXPECT_EQ(heap_allocations, before);
  EXPECT_TRUE(is_same);
  EXPECT_GT(contacts, 2000);
}

// The tip moves along the table, through three boxes in a row, one of them over the edge; release
// and reset.
TEST(HapticWorld, IsDeterministicAndDoesNotAllocate) {
  HapticWorldModel model = test::one_box_on_a_table(0.001);
  model.world.bodies = test::row_of_boxes(3, 0.002).bodies;
  HapticWorld first = HapticWorld::create(model).value();
  HapticWorld second = HapticWorld::create(model).value();
  const Eigen::Vector3d start = test::touching_tip(0.01, 0.02);
  btAlignedAllocSetCustom(count_bullet_allocation, std::free);
  const long before = heap_allocations;
  bool is_same = true;
  bool has_fallen = false;
  for (int i = 0; i < 3000; ++i) {
    if (i % 2500 == 0) {
      first.reset(start);
      second.reset(start);
    }
    const Eigen::Vector3d tip =
        start + Eigen::Vector3d(0.1 * i * kCycle, 0.0, -0.02 * std::sin(5.0 * i * kCycle));
    const ToolCommand command{tip, i % 700 < 650};
    first.step(command, kCycle);
    second.step(command, kCycle);
    const HapticWorldState& a = first.state();
    const HapticWorldState& b = second.state();
    is_same &= a.p_base_proxy == b.p_base_proxy && a.force_base == b.force_base;
    for (std::size_t k = 0; k < 3; ++k) {
      const Pose& T_a = a.bodies[k].T_base_object;
      const Pose& T_b = b.bodies[k].T_base_object;
      is_same &= T_a.translation() == T_b.translation() &&
                 T_a.rotation().coeffs() == T_b.rotation().coeffs();
    }
    has_fallen |= a.bodies[2].is_outside_model;
  }
  const long during = heap_allocations - before;
  btAlignedAllocSetCustom(nullptr, nullptr);
  EXPECT_EQ(during, 0);
  EXPECT_TRUE(has_fallen);
  EXPECT_TRUE(is_same);
}

}  // namespace
}  // namespace pcavr
