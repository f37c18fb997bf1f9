// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Many recordings of one object, one answer.
#include "pcavr/pipeline/identify_runs.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/object/parameters_file.hpp"

#include "pipeline/identified_case.hpp"

namespace pcavr {
namespace {

/// Runs of the same bodies and pushes, each with other noise. The last one may have a force that
/// is 1.5 times too large, which no weighed mass shows.
std::vector<IdentificationRun> make_runs(std::size_t count, bool is_last_stronger = false) {
  std::vector<IdentificationRun> runs;
  for (std::size_t k = 0; k < count; ++k) {
    IdentifiedCase made = identified_case(ToolTask::push, 12, 60.0, {}, 100 + k);
    IdentificationInput input = std::move(made.input);
    for (IdentifiableObject& object : input.objects) object.mass.reset();
    if (is_last_stronger && k + 1 == count) {
      for (Eigen::Vector3d& force : input.force_base) force *= 1.5;
    }
    runs.push_back({"run-" + std::to_string(k),
                    Stamp::from_seconds(1000.0 * static_cast<double>(k)), std::move(input)});
  }
  return runs;
}

const PooledParameter& coefficient_of(const PooledObject& object, const std::string& name) {
  return *std::ranges::find(object.parameters, name, &PooledParameter::name);
}

TEST(IdentifyRuns, AreMoreCertainTogetherAndTheSameInAnyOrder) {
  std::vector<IdentificationRun> runs = make_runs(4);
  const auto found = identify_runs(runs, IdentificationGoal::friction, {});
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const PooledParameter& limit = coefficient_of(found->objects[0], "limiting_static_friction");
  ASSERT_EQ(limit.runs.size(), 4U);
  double least = *limit.runs.front().value.std;
  for (const auto& run : limit.runs) least = std::min(least, *run.value.std);
  EXPECT_LT(*limit.pooled.std, least);
  std::swap(runs[0], runs[2]);
  std::swap(runs[1], runs[3]);
  const auto again = identify_runs(runs, IdentificationGoal::friction, {});
  ASSERT_TRUE(again.has_value()) << again.error().to_string();
  EXPECT_EQ(format_parameters(found->parameters()), format_parameters(again->parameters()));
}

TEST(IdentifyRuns, LeaveOutTheOneThatContradictsTheOthers) {
  const auto found = identify_runs(make_runs(5, true), IdentificationGoal::friction, {});
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_EQ(found->objects[0].left_out, std::vector<std::size_t>{4});
  const bool is_named = std::ranges::any_of(found->warnings, [](const std::string& warning) {
    return warning.find("run-4 is left out") != std::string::npos;
  });
  EXPECT_TRUE(is_named);
}

TEST(IdentifyRuns, RefuseOneTwiceAndBodiesThatDiffer) {
  std::vector<IdentificationRun> runs = make_runs(2);
  runs.push_back(runs.front());
  runs.back().name = "again";
  auto found = identify_runs(runs, IdentificationGoal::friction, {});
  ASSERT_FALSE(found.has_value());
  EXPECT_NE(found.error().to_string().find("is the same recording as"), std::string::npos);
  runs.pop_back();
  runs[1].input.objects[0].model.mesh_object.vertices[0].x() += 0.01F;
  found = identify_runs(runs, IdentificationGoal::friction, {});
  ASSERT_FALSE(found.has_value());
  EXPECT_NE(found.error().to_string().find("has another CAD body than in"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
