// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/core/gravity.hpp"
#include "pcavr/friction/limit_surface.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "pipeline/identified_case.hpp"
#include "pipeline/input_faults.hpp"

namespace pcavr {
namespace {

constexpr double kWhole = 600.0;  // [s] longer than any case

TEST(IdentifyMany, ReachesItsErrorBoundsOnRandomBoxes) {
  int identified_masses = 0;
  for (std::uint64_t seed = 21; seed <= 25; ++seed) {
    const IdentifiedCase made = identified_case(ToolTask::probe, seed, kWhole);
    const auto found = identify(made.input, IdentificationGoal::friction);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    for (std::size_t i = 0; i < 2; ++i) {
      const PlantParameters& truth = made.plant.bodies[i].parameters;
      const ObjectIdentification& box = found->objects[i];
      const std::string at = std::to_string(seed) + "_" + std::to_string(i);
      const double limit = box.limit.mean / truth.limiting_static_friction - 1.0;
      RecordProperty("limit_percent_" + at, std::to_string(100.0 * limit));
      RecordProperty("limit_std_" + at, std::to_string(box.limit.std));
      EXPECT_LT(std::abs(limit), 0.02) << at;
      const double friction = truth.sliding_friction_coefficient * truth.mass * kStandardGravity +
                              truth.viscous_friction * box.sliding.speed;
      const double sliding =
          (box.sliding.coulomb.value + box.sliding.viscous.value * box.sliding.speed) / friction -
          1.0;
      RecordProperty("sliding_percent_" + at, std::to_string(100.0 * sliding));
      EXPECT_LT(std::abs(sliding), 0.03) << at;
      if (!box.sliding.mass.is_excited) continue;
      ++identified_masses;
      RecordProperty("mass_percent_" + at,
                     std::to_string(100.0 * (box.sliding.mass.value / truth.mass - 1.0)));
      EXPECT_NEAR(box.sliding.mass.value, truth.mass,
                  std::max(0.05 * truth.mass, 2.0 * box.sliding.mass.std));
    }
  }
  EXPECT_GE(identified_masses, 8);  // of ten: the probe's motion excites the mass
}

TEST(IdentifyMany, FindsNoFaultInSoundRecordings) {
  for (const ToolTask task : {ToolTask::push, ToolTask::probe, ToolTask::press, ToolTask::turn}) {
    for (std::uint64_t seed = 61; seed <= 66; ++seed) {
      for (const double duration : {2.5, 7.0, 12.0}) {
        IdentificationInput input = identified_case(task, seed, duration).input;
        for (const bool is_tracked : {true, false}) {
          if (!is_tracked) {
            for (IdentifiableObject& object : input.objects) object.tracked.clear();
          }
          const auto found = identify(input, IdentificationGoal::friction);
          EXPECT_FALSE(!found && reports_fault(found.error().to_string()))
              << seed << ": " << found.error().to_string();
        }
      }
    }
  }
}

TEST(IdentifyMany, FindsTheFrictionRadiusOfBoxes) {
  const IdentifiedCase made = identified_case(ToolTask::turn, 3, kWhole);
  const auto found = identify(made.input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  for (std::size_t i = 0; i < 2; ++i) {
    const double radius = friction_radius(made.plant.bodies[i].patches);
    const ObjectIdentification& box = found->objects[i];
    ASSERT_TRUE(box.friction_radius.has_value());
    RecordProperty("radius_percent_" + std::to_string(i),
                   std::to_string(100.0 * (box.friction_radius->value / radius - 1.0)));
    EXPECT_NEAR(box.friction_radius->value, radius, 0.15 * radius);
    EXPECT_EQ(box.surface.status, LimitSurfaceFitStatus::fitted);
    EXPECT_LT(box.surface.median_angle, 0.1);
  }
}

}  // namespace
}  // namespace pcavr
