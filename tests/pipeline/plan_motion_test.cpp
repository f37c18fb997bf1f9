// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/plan_motion.hpp"

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/simulation/live_plant.hpp"
#include "pcavr/teleoperation/devices/trace_device.hpp"

#include "identified_case.hpp"

namespace pcavr {
namespace {

Identification identified(const IdentificationInput& input) {
  Expected<Identification> found = identify(input, IdentificationGoal::friction);
  EXPECT_TRUE(found.has_value()) << found.error().to_string();
  return *found;
}

/// The plant with its bodies where `input` saw them last: upright on the table.
PlantCase left_by(const IdentificationInput& input, PlantCase plant) {
  plant.moves.clear();
  for (std::size_t i = 0; i < plant.bodies.size(); ++i) {
    const Pose& seen = input.objects[i].tracked.back().T_base_object;
    Eigen::Vector3d p_base = plant.bodies[i].T_base_object.translation();
    p_base.head<2>() = seen.translation().head<2>();
    const Eigen::AngleAxisd turned(heading_of(seen), Eigen::Vector3d::UnitZ());
    plant.bodies[i].T_base_object = Pose(Eigen::Quaterniond(turned), p_base);
  }
  return plant;
}

Eigen::Vector3d command_at(const std::vector<PlannedPoint>& path, double t) {
  const auto next = std::find_if(path.begin(), path.end(),
                                 [t](const PlannedPoint& point) { return point.t > t; });
  if (next == path.begin()) return path.front().p_base;
  if (next == path.end()) return path.back().p_base;
  const PlannedPoint& last = *(next - 1);
  const double share = (t - last.t) / (next->t - last.t);
  return last.p_base + share * (next->p_base - last.p_base);
}

/// The recording while the plant's tool follows the path.
IdentificationInput recorded_along(const std::vector<PlannedPoint>& path,
                                   const IdentificationInput& before, PlantCase plant,
                                   std::uint64_t seed) {
  plant.tool.p_base_start = path.front().p_base;
  LivePlant live(plant, seed);
  LivePlantSamples samples;
  IdentificationInput input = before;
  const double duration = path.back().t + 0.5;
  while (live.t() < duration) live.step(command_at(path, live.t()), samples);
  input.t_tool.clear();
  input.p_base_tip.clear();
  input.q_base_tool.clear();
  input.t_force.clear();
  input.force_base.clear();
  for (const LivePlantSamples::Tool& tool : samples.tool) {
    input.t_tool.push_back(tool.t);
    input.p_base_tip.push_back(tool.T_base_tool.translation());
    input.q_base_tool.push_back(tool.T_base_tool.rotation());
  }
  for (const LivePlantSamples::Wrench& wrench : samples.wrench) {
    input.t_force.push_back(wrench.t);
    input.force_base.push_back(wrench.force_base);
  }
  for (std::size_t i = 0; i < plant.bodies.size(); ++i) {
    input.objects[i].T_base_object = plant.bodies[i].T_base_object;
    input.objects[i].tracked.clear();
  }
  for (const LivePlantSamples::Tracked& seen : samples.tracked) {
    input.objects[seen.body].tracked.push_back(
        {seen.t, seen.T_base_object, seen.position_std, seen.rotation_std});
  }
  return input;
}

std::optional<double> std_of(const ObjectIdentification& found, const std::string& name) {
  for (const ParameterFinding& row : found.findings) {
    if (row.name == name && row.is_excited) return row.std;
  }
  return std::nullopt;
}

/// Follows the advice on the plant, and compares the stds that it predicts with those that the
/// recording gives. Returns the number of compared ones.
int follow_advice(std::uint64_t seed, double duration, const IdentificationOptions& options) {
  IdentifiedCase made = identified_case(ToolTask::push, seed, duration);
  for (IdentifiableObject& object : made.input.objects) object.mass.reset();
  const MotionPlan plan = plan_motion(made.input, identified(made.input), options);
  EXPECT_FALSE(plan.path.empty());
  if (plan.path.empty()) return 0;
  const Identification found = identified(
      recorded_along(plan.path, made.input, left_by(made.input, made.plant), seed + 100));
  int compared = 0;
  for (std::size_t i = 0; i < plan.objects.size(); ++i) {
    for (const PlannedStd& row : plan.objects[i].stds) {
      if (!row.expected) continue;
      const std::optional<double> reached = std_of(found.objects[i], row.name);
      const std::string what = plan.objects[i].name + ' ' + row.name;
      EXPECT_TRUE(reached.has_value()) << what;
      EXPECT_LT(reached.value_or(0.0), 1.5 * *row.expected) << what << ", seed " << seed;
      ++compared;
    }
  }
  return compared;
}

TEST(PlanMotion, ReachesTheStdsThatItPredictsOnThePlant) {
  IdentificationOptions options;
  options.plan.max_contacts = 4;  // for the test's time
  EXPECT_GE(follow_advice(22, 40.0, options), 6);
}

/// A recording of a short push, and its plan by these options.
struct Planned {
  IdentifiedCase made = identified_case(ToolTask::push, 5, 20.0);
  Identification found = identified(made.input);

  [[nodiscard]] MotionPlan by(const PlanOptions& plan) const {
    IdentificationOptions options;
    options.plan = plan;
    return plan_motion(made.input, found, options);
  }
};

TEST(PlanMotion, IsATraceThatTheToolCanFollow) {
  const Planned planned;
  const PlanOptions options;
  const MotionPlan plan = planned.by(options);
  ASSERT_FALSE(plan.path.empty());
  EXPECT_EQ(format_path(plan), format_path(planned.by(options))) << "not deterministic";
  const auto trace = parse_trace(format_path(plan), "plan.csv");
  ASSERT_TRUE(trace.has_value()) << trace.error().to_string();
  EXPECT_EQ(trace->size(), plan.path.size());
  double top = 0.0;
  for (const PlantBody& body : planned.made.plant.bodies) {
    for (const PlantCuboid& part : body.parts) {
      top = std::max(
          top, body.T_base_object.translation().z() + part.centre.z() + part.half_extents.z());
    }
  }
  EXPECT_NEAR(plan.path.front().p_base.z(),
              top + planned.made.input.tool_radius + options.clearance, 1e-3);
  constexpr double kTravelSpeed = 0.25;
  for (std::size_t i = 1; i < plan.path.size(); ++i) {
    const double time = plan.path[i].t - plan.path[i - 1].t;
    ASSERT_GT(time, 0.0) << i;
    EXPECT_LE((plan.path[i].p_base - plan.path[i - 1].p_base).norm() / time, kTravelSpeed + 1e-9);
  }
}

TEST(PlanMotion, AsksForLessWhereLessIsWished) {
  const Planned planned;
  PlanOptions modest;
  modest.exponent_std = modest.mass_std = modest.coefficient_std = modest.limit_std = 1.0;
  modest.viscous_std = modest.damping_std = 10.0;
  PlanOptions strict;
  strict.coefficient_std = 0.012;
  const MotionPlan few = planned.by(modest), usual = planned.by({}), many = planned.by(strict);
  ASSERT_EQ(few.objects.size(), usual.objects.size());
  for (std::size_t i = 0; i < few.objects.size(); ++i) {
    EXPECT_LE(few.objects[i].slides, 1);
    EXPECT_LE(usual.objects[i].slides, many.objects[i].slides);
    EXPECT_LE(few.objects[i].breakaways + few.objects[i].slides,
              usual.objects[i].breakaways + usual.objects[i].slides);
  }
}

TEST(PlanMotion, ASlideNeverStops) {
  PlanOptions options;
  for (const double frequency : {0.5, 2.0, 5.0}) {
    options.frequency = frequency;
    const SlideMotion motion = planned_slide(options);
    const double swing = 2.0 * std::numbers::pi * motion.frequency * motion.amplitude;
    EXPECT_LT(swing, 0.7 * motion.speed);
    EXPECT_LE(motion.speed + swing, options.max_speed + 1e-12);
  }
}

}  // namespace
}  // namespace pcavr
