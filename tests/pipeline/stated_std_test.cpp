// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "support/shared_data.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxScore = 5.0;  // stds: beyond, a stated std is wrong

Identification identified(const fs::path& folder) {
  const Expected<Recording> recording = read_recording(folder);
  EXPECT_TRUE(recording.has_value()) << recording.error().to_string();
  const Expected<IdentificationInput> input =
      identification_input(*recording, {.tracked = folder / "tracked"});
  EXPECT_TRUE(input.has_value()) << input.error().to_string();
  const Expected<Identification> found = identify(*input, IdentificationGoal::friction);
  EXPECT_TRUE(found.has_value()) << found.error().to_string();
  return *found;
}

void expect_covered(const std::optional<ParameterValue>& found,
                    const std::optional<ParameterValue>& truth, const std::string& where) {
  ASSERT_TRUE(found && found->std && truth) << where;
  EXPECT_LT(std::abs(found->value - truth->value), kMaxScore * *found->std)
      << where << ": " << found->value << " +- " << *found->std << ", truth " << truth->value;
}

/// The stated stds of sliding friction cover the truth, and the force at the pushed speeds is
/// exact.
void expect_sliding(const fs::path& folder, double max_error) {
  const Identification found = identified(folder);
  const Expected<ParameterTable> table = read_parameters(folder / "truth/parameters.yaml");
  ASSERT_TRUE(table.has_value());
  const ObjectParameters& truth = table->at("body");
  const ObjectIdentification& body = found.objects.front();
  const std::string where = folder.filename().string();
  expect_covered(body.parameters.sliding_friction_coefficient, truth.sliding_friction_coefficient,
                 where + " coefficient");
  expect_covered(body.parameters.viscous_friction, truth.viscous_friction, where + " viscous");
  const double coulomb =
      truth.sliding_friction_coefficient->value * truth.mass->value * kStandardGravity;
  EXPECT_FALSE(body.friction.sliding_force.empty()) << where;
  for (const SlidingForce& row : body.friction.sliding_force) {
    const double force = coulomb + truth.viscous_friction->value * row.speed;
    EXPECT_NEAR(row.force, force, max_error * force) << where << " at " << row.speed;
    EXPECT_LT(std::abs(row.force - force), kMaxScore * row.std) << where << " at " << row.speed;
  }
}

TEST(LaboratoryPush, HasTheCoefficientOfASlowUnsteadySlideAlongTheFace) {
  PCAVR_NEEDS_SHARED_DATA("real/push_mit_delrin/d1396");
  const Identification found = identified(shared_data("real/push_mit_delrin/d1396"));
  const auto& coefficient = found.objects.front().parameters.sliding_friction_coefficient;
  ASSERT_TRUE(coefficient && coefficient->std);
  // The median of |F| while it moves, over its weight.
  EXPECT_NEAR(coefficient->value, 0.29, 0.05 * 0.29);
  EXPECT_LT(*coefficient->std, 0.1 * 0.29);
}

TEST(StatedStds, OfSlidingFrictionCoverTheTruthOfOtherPlants) {
  PCAVR_NEEDS_SHARED_DATA("plants/probe-1");
  for (int seed = 1; seed <= 6; ++seed) {
    const fs::path plants = shared_data("plants");
    expect_sliding(plants / ("probe-" + std::to_string(seed)), 0.02);
    expect_sliding(plants / ("push-" + std::to_string(seed)), 0.05);
  }
}

TEST(StatedStds, OfLimitingFrictionCoverTheTruthOfOtherPlants) {
  PCAVR_NEEDS_SHARED_DATA("plants/probe-1");
  constexpr double kMaxError = 0.06;
  for (const char* kind : {"probe-", "push-"}) {
    for (int seed = 1; seed <= 6; ++seed) {
      const std::string where = kind + std::to_string(seed);
      const fs::path folder = shared_data("plants") / where;
      const Expected<ParameterTable> table = read_parameters(folder / "truth/parameters.yaml");
      ASSERT_TRUE(table.has_value());
      const auto& truth = table->at("body").limiting_static_friction;
      const Identification found = identified(folder);
      const auto& limit = found.objects.front().parameters.limiting_static_friction;
      expect_covered(limit, truth, where);
      EXPECT_NEAR(limit->value, truth->value, kMaxError * truth->value) << where;
    }
  }
}

}  // namespace
}  // namespace pcavr
