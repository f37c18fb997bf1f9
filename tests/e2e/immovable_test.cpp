// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Presses on boxes that are fixed to the table, with the real command: identify, then replay over a
// delayed link, with and without the identified parameters. The seed is used in this file only.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

#include "support/json_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr double kDepth = 0.002;  // [m] of paper B's presses

struct PressForces {
  double t = 0.0;         ///< [s]
  double measured = 0.0;  ///< [N]
  double rendered = 0.0;
};

/// force.csv of a run, by object.
std::map<std::string, std::vector<PressForces>> read_forces(const std::string& run) {
  std::map<std::string, std::vector<PressForces>> rows;
  std::istringstream text(read_file(run + "/force.csv").value());
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream fields(line);
    std::string t, object, measured, rendered;
    std::getline(fields, t, ',');
    std::getline(fields, object, ',');
    std::getline(fields, measured, ',');
    std::getline(fields, rendered, ',');
    rows[object].push_back({std::stod(t), std::stod(measured), std::stod(rendered)});
  }
  return rows;
}

/// Rendered over measured force, both averaged over the samples from `from` [s] on in which the tip
/// rests deep in the object: over 60 ms the rendered force changes by less than 1 %, and it is more
/// than half of its maximum. The mean of the measured force is an unbiased estimate of the plant's.
double ratio_at_rest(const std::vector<PressForces>& rows, double from) {
  constexpr std::size_t kHalfWindow = 15;  // samples at 500 Hz
  constexpr double kMaxWindow = 0.07;      // [s] a longer one spans two presses
  double peak = 0.0;
  for (const PressForces& row : rows) peak = std::max(peak, row.rendered);
  double measured = 0.0;
  double rendered = 0.0;
  for (std::size_t i = kHalfWindow; i + kHalfWindow < rows.size(); ++i) {
    const PressForces& before = rows[i - kHalfWindow];
    const PressForces& after = rows[i + kHalfWindow];
    const bool is_deep = rows[i].t >= from && rows[i].rendered > 0.5 * peak;
    const bool is_at_rest = after.t - before.t < kMaxWindow &&
                            std::abs(after.rendered - before.rendered) < 0.01 * rows[i].rendered;
    if (!is_deep || !is_at_rest) continue;
    measured += rows[i].measured;
    rendered += rows[i].rendered;
  }
  return rendered / measured;
}

class ImmovableObjects : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_json({"simulate", "press", "-o", path_of("press"), "--no-images", "--immovable", "--seed",
              "8311"});
    run_json({"build", path_of("press"), "-o", path_of("scene")});
    run_json({"identify", "contact", path_of("press"), "--scene", path_of("scene"), "-o",
              path_of("parameters.yaml")});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path_of(const std::string& name) { return (folder_->path() / name).string(); }
  static std::map<std::string, std::vector<PressForces>> replay(
      const std::string& run, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"replay", path_of("press"), "--scene", path_of("scene"),
                                          "-o",     path_of(run)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run_json(arguments);
    return read_forces(path_of(run));
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* ImmovableObjects::folder_ = nullptr;

TEST_F(ImmovableObjects, AreIdentifiedToThePlantsForceAtTwoMillimetres) {
  const ParameterTable found = read_parameters(path_of("parameters.yaml")).value();
  const ParameterTable truth = read_parameters(path_of("press/truth/parameters.yaml")).value();
  for (const std::string box : {"box_1", "box_2"}) {
    const auto law = contact_law_of(found.at(box));
    ASSERT_TRUE(law) << box;
    const double ratio =
        elastic_force(*law, kDepth) / elastic_force(*contact_law_of(truth.at(box)), kDepth);
    std::printf("  %s: identified over true force at 2 mm: %.4f\n", box.c_str(), ratio);
    EXPECT_NEAR(ratio, 1.0, 0.05) << box;
    // Parameters of friction are not identified of a body that does not move.
    EXPECT_FALSE(found.at(box).limiting_static_friction) << box;
  }
}

TEST_F(ImmovableObjects, AreRenderedByTheirIdentifiedLaw) {
  const auto forces = replay("known", {"--parameters", path_of("parameters.yaml")});
  for (const std::string box : {"box_1", "box_2"}) {
    ASSERT_TRUE(forces.contains(box));
    const double ratio = ratio_at_rest(forces.at(box), 0.0);
    std::printf("  %s: rendered over measured force, at rest: %.4f\n", box.c_str(), ratio);
    EXPECT_NEAR(ratio, 1.0, 0.05) << box;
  }
}

TEST_F(ImmovableObjects, AreLearnedDuringReplayWithoutParameters) {
  const auto forces = replay("unknown", {});
  for (const std::string box : {"box_1", "box_2"}) {
    const std::vector<PressForces>& rows = forces.at(box);
    // The law is sent after the first presses; the last half is rendered by it.
    const double middle = 0.5 * (rows.front().t + rows.back().t);
    const double ratio = ratio_at_rest(rows, middle);
    std::printf("  %s: rendered over measured force, learned: %.4f\n", box.c_str(), ratio);
    EXPECT_NEAR(ratio, 1.0, 0.05) << box;
  }
  const std::string run = read_file(path_of("unknown/phases.csv")).value();
  EXPECT_EQ(run.find("sliding"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
