// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/push.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "simulation/layout.hpp"

namespace pcavr::simulation {
namespace {

constexpr double kDuration = 8.0;

World two_boxes(std::uint64_t seed) {
  SimulationCase push;
  push.is_camera_fixed = true;
  push.movable_boxes = 2;
  push.with_moving_tool = true;
  push.clutter = 0;
  return make_world(push, seed, {}).value();
}

/// How deep the tip is in the box's face at a step [m].
double indentation(const World& world, const PushRun& run, std::size_t box, std::size_t step) {
  const double face = world.boxes[box].T_base_object.translation().y() -
                      world.boxes[box].half_extents.y() + run.slid[box][step];
  return run.tip[step].y() + world.tool_radius - face;
}

/// Of the boxes that the tip is level with and behind of; negative where it touches none.
double deepest_indentation(const World& world, const PushRun& run, std::size_t step) {
  double deepest = -1.0;
  for (std::size_t box = 0; box < world.boxes.size(); ++box) {
    const double centre = world.boxes[box].T_base_object.translation().y() + run.slid[box][step];
    const bool is_level = run.tip[step].z() < 2.0 * world.boxes[box].half_extents.z();
    if (is_level && run.tip[step].y() < centre) {
      deepest = std::max(deepest, indentation(world, run, box, step));
    }
  }
  return deepest;
}

std::size_t step_of(double t) { return static_cast<std::size_t>(std::lround(t / PushRun::kStep)); }

TEST(Push, EveryBoxPassesThroughThePhasesInTheirOrder) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const World world = two_boxes(seed);
    const PushRun run = simulate_push(world, kDuration, seed);
    for (std::size_t box = 0; box < 2; ++box) {
      std::vector<PushPhase> phases;
      for (const PhaseChange& change : run.phases) {
        if (change.box == box) phases.push_back(change.phase);
      }
      const std::vector<PushPhase> expected{
          PushPhase::free,    PushPhase::static_friction, PushPhase::critical,
          PushPhase::sliding, PushPhase::static_friction, PushPhase::free};
      EXPECT_EQ(phases, expected) << "seed " << seed << ", box " << box;
    }
  }
}

TEST(Push, ABoxSlidesAsFarAsTheToolGoes) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const PushRun run = simulate_push(two_boxes(seed), kDuration, seed);
    for (const std::vector<double>& slid : run.slid) {
      EXPECT_TRUE(std::is_sorted(slid.begin(), slid.end()));
      // The tip springs back by some part of its indentation, under 1 mm.
      EXPECT_NEAR(slid.back(), kSlideDistance, 0.001) << "seed " << seed;
    }
  }
}

TEST(Push, TheToolTouchesWhereItPushesAndSinksInByLessThanItsGive) {
  const World world = two_boxes(3);
  const PushRun run = simulate_push(world, kDuration, 3);
  for (std::size_t step = 0; step < run.tip.size(); ++step) {
    const double deepest = deepest_indentation(world, run, step);
    // 0.9 mm at breakaway, and a little more while the box gains speed.
    EXPECT_LT(deepest, 0.0012) << "at step " << step;
    // The force is the mean over the step that begins there: 0.3 mm covers the way in it.
    const bool is_pushing = run.force[step] > 0.0;
    EXPECT_TRUE(!is_pushing || deepest > -3e-4) << "at step " << step;
    EXPECT_TRUE(is_pushing || deepest < 3e-4) << "at step " << step;
  }
}

TEST(Push, BoxesNeverOverlapEachOther) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const World world = two_boxes(seed);
    const PushRun run = simulate_push(world, kDuration, seed);
    const double gap = world.boxes[1].T_base_object.translation().y() -
                       world.boxes[1].half_extents.y() -
                       world.boxes[0].T_base_object.translation().y() -
                       world.boxes[0].half_extents.y() - run.slid[0].back();
    // The tool has to come down between them.
    EXPECT_GT(gap, 2.0 * world.tool_radius) << "seed " << seed;
  }
}

TEST(Push, BreaksAwayAtTheLimitAndSlidesAtCoulombsForce) {
  const World world = two_boxes(5);
  const PushRun run = simulate_push(world, kDuration, 5);
  for (const PhaseChange& change : run.phases) {
    if (change.phase != PushPhase::sliding) continue;
    const PushParameters& p = run.parameters[change.box];
    const std::size_t begin = step_of(change.t);
    const double most = *std::max_element(run.force.begin() + static_cast<long>(begin) - 20,
                                          run.force.begin() + static_cast<long>(begin) + 20);
    EXPECT_GE(most, 0.99 * p.limiting_static_friction);
    // Newton's second law over 100 ms of sliding; the force is averaged, so 2 % is rounding.
    const std::size_t from = begin + 150;
    const std::size_t to = from + 100;
    const auto speed = [&](std::size_t step) {
      return (run.slid[change.box][step + 1] - run.slid[change.box][step]) / PushRun::kStep;
    };
    double impulse = 0.0;
    for (std::size_t i = from; i < to; ++i) impulse += run.force[i] * PushRun::kStep;
    const double way = run.slid[change.box][to] - run.slid[change.box][from];
    const double friction =
        p.sliding_friction_coefficient * p.mass * 9.81 * 0.1 + p.viscous_friction * way;
    const double momentum = p.mass * (speed(to) - speed(from));
    EXPECT_NEAR(impulse, friction + momentum, 0.02 * friction);
  }
}

TEST(Push, WithoutAToolNothingMoves) {
  SimulationCase still;
  const World world = make_world(still, 1, {}).value();
  const PushRun run = simulate_push(world, kDuration, 1);
  EXPECT_TRUE(run.tip.empty());
  const std::vector<Pose> poses = body_poses(world, run, 1.5);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[1].translation(), world.boxes[0].T_base_object.translation());
}

}  // namespace
}  // namespace pcavr::simulation
