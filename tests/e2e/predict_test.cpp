// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Questions to an arm through the real command, with parameters that the command identified.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "robot_identification/simulated_arm.hpp"
#include "support/json_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// Runs the command with --json, and expects the exit code of an answer that is no.
nlohmann::json answer_no(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const CommandOutcome outcome = run_pcavr(arguments);
  EXPECT_EQ(outcome.exit_code, 3) << outcome.standard_error;
  return nlohmann::json::parse(outcome.standard_output, nullptr, false);
}

std::string pa10_description() {
  return (source_folder() / "calib/robots/pa10/pa10.urdf").string();
}

/// The PA-10 as `pcavr identify robot` finds it from a log.
class PredictTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder();
    const std::string log = (folder_->path() / "joints.csv").string();
    ASSERT_TRUE(write_file(
        log, format_joint_log(simulated_log(pa10(), {.duration = 20.0, .rate = 200.0}))));
    (void)run_json({"identify", "robot", log, "--robot", pa10_description(), "-o", report()});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static std::string report() { return (folder_->path() / "report").string(); }

  static std::vector<std::string> question(const std::string& what,
                                           const std::vector<std::string>& more) {
    std::vector<std::string> words{"predict",      what,     "--robot",  pa10_description(),
                                   "--identified", report(), "--joints", "0",
                                   "0.6",          "0",      "1.0",      "0",
                                   "0.5",          "0"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* PredictTest::folder_ = nullptr;

TEST_F(PredictTest, TheTipReachesANearPointInTimeButNotAtOnce) {
  const std::vector<std::string> near{"--point", "0.65", "0.15", "0.55"};
  const nlohmann::json earliest = run_json(question("reach", near));
  ASSERT_TRUE(earliest["is_possible"].get<bool>()) << earliest.dump();
  const double least = earliest["min_time"].get<double>();
  std::vector<std::string> sooner = near;
  sooner.insert(sooner.end(), {"--time", std::to_string(0.5 * least)});
  const nlohmann::json answer = answer_no(question("reach", sooner));
  EXPECT_FALSE(answer["is_possible"].get<bool>());
  EXPECT_FALSE(answer["reason"].get<std::string>().empty());
}

TEST_F(PredictTest, AForceBeyondTheMotorsCannotBeHeld) {
  const std::vector<std::string> force{"--point", "0.65", "0.1", "0.55", "--force", "0", "0"};
  std::vector<std::string> light = force;
  light.emplace_back("-20");
  std::vector<std::string> heavy = force;
  heavy.emplace_back("-2000");
  const nlohmann::json held = run_json(question("hold", light));
  EXPECT_TRUE(held["is_possible"].get<bool>()) << held.dump();
  EXPECT_GT(held["max_force"].get<double>(), 20.0);
  const nlohmann::json refused = answer_no(question("hold", heavy));
  EXPECT_FALSE(refused["is_possible"].get<bool>());
  EXPECT_LT(refused["max_force"].get<double>(), 2000.0);
}

TEST_F(PredictTest, APushKnowsTheBodysFriction) {
  const std::string parameters = (folder_->path() / "parameters.yaml").string();
  ASSERT_TRUE(write_file(parameters,
                         "format: pcavr-parameters/2\nbox:\n  mass: 2.0\n"
                         "  sliding_friction_coefficient: 0.3\n"));
  std::vector<std::string> push =
      question("push", {"--point", "0.65", "0.1", "0.5", "--direction", "0", "1", "--distance",
                        "0.02", "--object", "box", "--parameters", parameters});
  const nlohmann::json answer = run_json(push);
  // sqrt(2 mu g d)
  EXPECT_NEAR(answer["speed"].get<double>(), 0.343, 0.001);
  EXPECT_TRUE(answer["is_possible"].get<bool>()) << answer.dump();
}

TEST_F(PredictTest, NamesTheLinkWhoseMeshIsMissing) {
  std::string text = read_file(pa10_description()).value();
  const std::string link = "<link name=\"tool\"/>";
  const std::size_t at = text.find(link);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, link.size(),
               "<link name=\"tool\"><visual><geometry><mesh filename=\"none.stl\"/></geometry>"
               "</visual></link>");
  const std::string robot = (folder_->path() / "robot.urdf").string();
  ASSERT_TRUE(write_file(robot, text));
  const CommandOutcome outcome =
      run_pcavr({"predict", "reach", "--robot", robot, "--point", "0.65", "0.15", "0.55"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.standard_error.find("no mesh file of link 'tool'"), std::string::npos)
      << outcome.standard_error;
}

TEST_F(PredictTest, BadInputIsOneLine) {
  const auto fails = [](const std::vector<std::string>& words, const std::string& why) {
    const CommandOutcome outcome = run_pcavr(words);
    EXPECT_NE(outcome.exit_code, 0);
    EXPECT_NE(outcome.standard_error.find(why), std::string::npos) << outcome.standard_error;
  };
  fails({"predict", "reach", "--robot", pa10_description(), "--point", "0.6", "0", "0.5",
         "--joints", "0", "1"},
        "7 joints");
  fails({"predict", "reach", "--robot", pa10_description(), "--point", "0.6", "0", "0.5",
         "--identified", pa10_description()},
        "identification report");
  fails({"predict", "reach", "--point", "0.6", "0", "0.5"}, "--robot");
  fails({"predict", "hold", "--robot", pa10_description(), "--point", "0.6", "0", "nan", "--force",
         "0", "0", "1"},
        "nan");
}

}  // namespace
}  // namespace pcavr
