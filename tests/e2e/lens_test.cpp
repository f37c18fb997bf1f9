// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Recordings with each lens model are built as accurately as with a pinhole; impossible distortion
// is rejected in one line (regression: it crashed the command).
#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "pcavr/simulation/simulate.hpp"

#include "support/json_command.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

SimulationCase tabletop() {
  const auto& cases = simulation_cases();
  return *std::find_if(cases.begin(), cases.end(),
                       [](const SimulationCase& one) { return one.name == "tabletop"; });
}

class ImpossibleCamera : public testing::TestWithParam<std::array<const char*, 4>> {};

TEST_P(ImpossibleCamera, IsRejectedInOneLine) {
  const auto& [name, from, to, expected_text] = GetParam();
  const TemporaryFolder folder;
  const fs::path recording = folder.path() / "recording";
  fs::create_directories(recording);
  SimulationCase simulation = tabletop();
  simulation.width = 320;
  simulation.height = 240;
  simulation.frame_rate = 1.0;
  ASSERT_TRUE(simulate(simulation, 1, recording, {2}));
  std::string text = read_file(recording / "recording.yaml").value();
  const std::size_t at = text.find(from);
  ASSERT_NE(at, text.npos) << text;
  ASSERT_TRUE(
      write_file(recording / "recording.yaml", text.replace(at, std::string(from).size(), to)));

  const fs::path scene = folder.path() / "scene";
  const CommandOutcome outcome = run_pcavr({"build", recording.string(), "-o", scene.string()});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
  EXPECT_NE(outcome.standard_error.find("recording.yaml:"), std::string::npos);
  EXPECT_NE(outcome.standard_error.find(expected_text), std::string::npos)
      << outcome.standard_error;
  EXPECT_FALSE(fs::exists(scene));
}

INSTANTIATE_TEST_SUITE_P(
    Each, ImpossibleCamera,
    testing::Values(std::array{"HalfARationalLens", "  depth_scale:",
                               "  distortion: [0.5285, -2.68, 0.0005, -0.0002, 1.51]\n"
                               "  depth_scale:",
                               "model: rational"},
                    std::array{"MinusOne", "  depth_scale:",
                               "  distortion: [-1, 0, 0, 0, 0]\n  depth_scale:", "folds"},
                    std::array{"FocalLengthOfNothing", "fx: 262.5", "fx: 1e-300", "focal length"}),
    [](const auto& test) { return std::string(test.param[0]); });

struct Lens {
  const char* name;
  LensModel model;
  std::vector<double> coefficients;
  double focal_length;  ///< [px]
};

void PrintTo(const Lens& lens, std::ostream* out) { *out << lens.name; }

class EachLens : public testing::TestWithParam<Lens> {};

TEST_P(EachLens, IsBuiltAsAccuratelyAsAPinhole) {
  const Lens& lens = GetParam();
  const TemporaryFolder folder;
  const fs::path recording = folder.path() / "recording";
  fs::create_directories(recording);
  SimulationCase simulation = tabletop();
  simulation.frame_rate *= 0.5;  // half the time of the test; a lens errs in each frame
  simulation.camera = simulated_camera(simulation);
  simulation.camera->fx = simulation.camera->fy = lens.focal_length;
  simulation.camera->distortion = LensDistortion(lens.model, lens.coefficients);
  ASSERT_TRUE(simulate(simulation, 3, recording, {2}));

  const std::string scene = (folder.path() / "scene").string();
  const json built = run_json({"build", recording.string(), "-o", scene});
  EXPECT_EQ(built["frames_used"], built["frames_recorded"]);
  const json report = run_json({"evaluate", scene, "--truth", (recording / "truth").string(), "-o",
                                (folder.path() / "report").string()});
  // The bounds for a pinhole, see position_error_test.cpp.
  expect_within(report, "camera.absolute.translation.rmse_m", 0.005);
  expect_within(report, "camera.absolute.rotation.rmse_rad", 0.007);
  expect_within(report, "mesh.accuracy.mean_m", 0.002);
  expect_within(report, "mesh.share_left_behind", 0.001);
  expect_within(report, "mesh.share_not_explained", 0.001);
  EXPECT_GE(report["mesh.completeness_10mm"].get<double>(), 0.95);
  std::printf("  mesh.completeness_10mm %.4f\n", report["mesh.completeness_10mm"].get<double>());
}

INSTANTIATE_TEST_SUITE_P(
    Each, EachLens,
    testing::Values(Lens{"PlumbBob", LensModel::plumb_bob, {-0.25, 0.08, 0.001, -0.0005, 0}, 525.0},
                    Lens{"Rational",
                         LensModel::rational,
                         {0.5285, -2.68, 0.0005, -0.0002, 1.51, 0.4095, -2.5, 1.44},
                         525.0},
                    Lens{"Fisheye", LensModel::fisheye, {-0.0117, 0.0301, -0.0274, 0.0079}, 400.0}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace pcavr
