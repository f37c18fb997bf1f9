// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "pcavr/physics/friction/planar_slider.hpp"
#include "pcavr/physics/friction/point_push.hpp"
#include "pcavr/physics/friction/slider.hpp"

#include "friction/surfaces.hpp"
#include "support/heap_counter.hpp"

namespace pcavr {
namespace {

TEST(Steps, DoNotAllocate) {
  Random random(30);
  PlanarFriction planar;
  planar.sliding = random_surface(random);
  PlanarState state;
  SliderState slider;
  const long before = heap_allocations;
  for (int i = 0; i < 1000; ++i) {
    const double force = i % 10 < 5 ? 60.0 : -20.0;
    state = step_planar(planar, state, {force, 0.2 * force, 0.01 * force}, 1e-3).state;
    slider = step_slider({3.0, 9.57, 0.9, 8.0, 4.0}, slider, {force, 0.5 * force}, 1e-3).state;
    const PushMotion motion =
        push_at_point(planar.sliding, {{0.1, 0.02}, {-1.0, 0.0}, 0.3, {-0.02, 0.01}});
    state.yaw += 1e-6 * motion.twist.z();
  }
  EXPECT_EQ(heap_allocations, before);
  EXPECT_NE(state.yaw, 0.0);
  EXPECT_NE(slider.position, 0.0);
}

}  // namespace
}  // namespace pcavr
