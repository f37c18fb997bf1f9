// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/results/evaluation/evaluate.hpp"

#include "support/shared_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

TEST(EvaluateTabletop, OfTheTruthAgainstItselfIsZero) {
  PCAVR_NEEDS_SHARED_DATA("tabletop/truth");
  const TemporaryFolder report;
  const fs::path truth = shared_data("tabletop/truth");
  const Expected<std::string> json = evaluate({truth, truth}, report.path(), Parallelism::max());
  ASSERT_TRUE(json.has_value()) << json.error().to_string();
  const Json metrics = Json::parse(*json);
  EXPECT_EQ(metrics["camera.absolute.translation.count"], 120);
  EXPECT_EQ(metrics["camera.absolute.translation.max_m"], 0.0);
  EXPECT_LT(metrics["camera.absolute_aligned.translation.max_m"], 1e-12);
  EXPECT_EQ(metrics["object.box.tracked.mssd.max_m"], 0.0);
  EXPECT_LT(metrics["mesh.accuracy.max_m"], 1e-6);  // floats of a few metres
  EXPECT_EQ(metrics["mesh.completeness_5mm"], 1.0);
  EXPECT_EQ(metrics["mesh.share_left_behind"], 0.0);
  EXPECT_GT(metrics["mesh.reference_samples"], 100000);
}

}  // namespace
}  // namespace pcavr
