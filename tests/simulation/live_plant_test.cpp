// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/live_plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/simulation/sensors.hpp"

namespace pcavr {
namespace {

/// The command of each step of a push at the middle of the first box's -y face.
Eigen::Vector3d push_at(const PlantCase& plant, double t) {
  const PlantBody& box = plant.bodies[0];
  const PlantCuboid& part = box.parts[0];
  const double gap = part.half_extents.y() + plant.tool.radius + 0.005;
  const Eigen::Vector3d start = box.T_base_object * (part.centre + Eigen::Vector3d(0.0, -gap, 0.0));
  const Eigen::Vector3d along = box.T_base_object.rotation() * Eigen::Vector3d::UnitY();
  return start + 0.03 * std::max(0.0, t - 0.2) * along;
}

PlantCase case_with_tool_at_box() {
  PlantCase plant = make_plant_case(ToolTask::push, 3);
  plant.tool.p_base_start = push_at(plant, 0.0);
  return plant;
}

TEST(LivePlant, APushedBoxBreaksAwayAndSlidesWithTheTip) {
  const PlantCase plant = case_with_tool_at_box();
  LivePlant live(plant, 3);
  LivePlantSamples samples;
  const Eigen::Vector2d before = live.body(0).p_base;
  double max_force = 0.0;
  for (int i = 0; i < 1500; ++i) live.step(push_at(plant, live.t()), samples);
  for (const LivePlantSamples::Wrench& wrench : samples.wrench) {
    max_force = std::max(max_force, wrench.force_base.norm());
  }
  // 39 mm of the command, less the gap and the compliance of arm and contact.
  EXPECT_NEAR((live.body(0).p_base - before).norm(), 0.034, 0.002);
  EXPECT_LT(
      (live.body(1).p_base - Eigen::Vector2d(plant.bodies[1].T_base_object.translation().head<2>()))
          .norm(),
      1e-9);
  EXPECT_GT(max_force, 0.9 * plant.bodies[0].parameters.limiting_static_friction);
  EXPECT_EQ(samples.tool.size(), 750U);
  EXPECT_EQ(samples.wrench.size(), 750U);
  EXPECT_EQ(samples.tracked.size(), 2U * 45U);
}

// The sensors are those of a recording: one code for both.
TEST(LivePlant, MeasuresAsARecordingOfTheSamePlant) {
  PlantCase plant = case_with_tool_at_box();
  plant.moves.clear();
  const PlantRun run = run_plant(plant.bodies, plant.tool, plant.moves, {.tail = 0.3});
  LivePlant live(plant, 5);
  LivePlantSamples samples;
  for (int i = 0; i < 300; ++i) live.step(plant.tool.p_base_start, samples);
  const Trajectory tool = measured_tool(run, 5);
  const std::vector<WrenchSample> wrench = measured_wrench(run, 5);
  ASSERT_GE(tool.size(), samples.tool.size());
  for (std::size_t i = 0; i < samples.tool.size(); ++i) {
    EXPECT_EQ(tool.poses()[i].pose.translation(), samples.tool[i].T_base_tool.translation());
  }
  for (std::size_t i = 0; i < samples.wrench.size(); ++i) {
    EXPECT_EQ(wrench[i].force, samples.wrench[i].force_base);
    EXPECT_NEAR(wrench[i].stamp.seconds(), samples.wrench[i].t, 1e-9);
  }
}

TEST(LivePlant, IsDeterministicAndIgnoresACommandThatIsNotFinite) {
  const PlantCase plant = case_with_tool_at_box();
  LivePlant a(plant, 3);
  LivePlant b(plant, 3);
  LivePlantSamples of_a;
  LivePlantSamples of_b;
  for (int i = 0; i < 500; ++i) {
    a.step(push_at(plant, a.t()), of_a);
    b.step(push_at(plant, b.t()), of_b);
  }
  EXPECT_EQ(a.body(0).p_base, b.body(0).p_base);
  EXPECT_EQ(of_a.wrench.back().force_base, of_b.wrench.back().force_base);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d tip = a.p_base_tip();
  for (int i = 0; i < 100; ++i) a.step({nan, 0.0, 0.0}, of_a);
  EXPECT_LT((a.p_base_tip() - tip).norm(), 0.005);
}

// The truth is in the scene's time: the plant's, and what it was skipped.
/// A tool that leaves a push in any direction, as after an interruption, also up along the face,
/// where its friction carries the box.
TEST(LivePlant, StaysFiniteHoweverTheToolLeavesAPush) {
  Random random(9);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    PlantCase plant = make_plant_case(ToolTask::push, seed);
    plant.tool.p_base_start = push_at(plant, 0.0);
    LivePlant live(plant, seed);
    LivePlantSamples samples;
    Eigen::Vector3d p_base = push_at(plant, 0.0);
    for (int leg = 0; leg < 12; ++leg) {
      const Eigen::Vector3d direction =
          leg % 3 == 0 ? push_at(plant, 1.2) - push_at(plant, 0.2)
                       : Eigen::Vector3d(random.normal(), random.normal(), 2.0 * random.normal());
      const double speed = leg % 3 == 0 ? 0.1 : 0.5 * random.uniform();  // [m/s]
      for (int i = 0; i < 120; ++i) {
        p_base += speed * LivePlant::kStep * direction.normalized();
        live.step(p_base, samples);
      }
      ASSERT_TRUE(live.p_base_tip().allFinite()) << seed << ' ' << leg;
      for (std::size_t i = 0; i < live.size(); ++i) {
        ASSERT_TRUE(live.body(i).p_base.allFinite() && live.body(i).twist.allFinite())
            << seed << ' ' << leg;
      }
    }
  }
}

TEST(LivePlant, KeepsWhatTrulyHappenedFromTheStartOnAndThroughASkip) {
  const PlantCase plant = case_with_tool_at_box();
  LivePlant live(plant, 3);
  LivePlantSamples samples;
  live.keep_run();
  for (int i = 0; i < 100; ++i) live.step(push_at(plant, 0.0), samples);
  live.skip(50);
  const double t_kept = live.t();
  for (int i = 0; i < 1400; ++i) live.step(push_at(plant, live.t()), samples);
  const PlantRun run = live.run();
  ASSERT_EQ(run.p_base_tip.size(), 1550U);
  ASSERT_EQ(run.bodies.size(), plant.bodies.size());
  EXPECT_EQ(run.p_base_tip[100], run.p_base_tip[149]);
  EXPECT_NEAR(t_kept, 0.1, 1e-9);
  EXPECT_LT((run.bodies[0].back().p_base - live.body(0).p_base).norm(), 1e-4);
  std::vector<PlantPhase> phases;
  for (const PlantPhaseChange& change : run.phases) {
    if (change.body == 0) phases.push_back(change.phase);
  }
  ASSERT_GE(phases.size(), 3U);
  EXPECT_EQ(phases.front(), PlantPhase::free);
  EXPECT_EQ(phases.back(), PlantPhase::sliding);
}

}  // namespace
}  // namespace pcavr
