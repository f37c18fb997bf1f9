// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Wrong command lines: exit code 2 (1 for options that exclude each other), one line, no output.
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

TEST(WrongUsage, ExitsWithTwo) {
  EXPECT_EQ(run_pcavr({}).exit_code, 2);
  EXPECT_EQ(run_pcavr({"build"}).exit_code, 2);
  EXPECT_EQ(run_pcavr({"simulate", "nosuchcase", "-o", "x"}).exit_code, 2);
  EXPECT_EQ(run_pcavr({"build", "r", "-o", "s", "--voxel", "-1"}).exit_code, 2);
}

TEST(WrongUsage, IsOneLineThatNamesTheCommandsHelp) {
  const CommandOutcome unknown = run_pcavr({"build", "r", "-o", "s", "--unknown"});
  EXPECT_EQ(std::count(unknown.standard_error.begin(), unknown.standard_error.end(), '\n'), 1);
  EXPECT_NE(unknown.standard_error.find("--unknown"), std::string::npos);
  EXPECT_NE(unknown.standard_error.find("see pcavr build --help"), std::string::npos)
      << unknown.standard_error;
}

TEST(WrongUsage, NamesAnUnknownCommand) {
  const CommandOutcome unknown = run_pcavr({"biuld", "recording"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.standard_error, "pcavr: unknown command 'biuld'; see pcavr --help\n");
}

TEST(Simulate, RejectsOptionsThatDoNotApplyToItsCaseInOneLine) {
  const TemporaryFolder folder;
  const std::string output = (folder.path() / "recording").string();
  struct Refusal {
    std::vector<std::string> arguments;
    std::string reason;
  };
  const Refusal refusals[] = {
      {{"probe", "--duration", "5"}, "lasts as long as its task"},
      {{"paper", "--objects", "3"}, "its task determines its bodies"},
      {{"push", "--no-images", "--frames-per-second", "5"}, "need images"},
      {{"tabletop", "--image-size", "640x480", "--depth-size", "320x200"},
       "is not 640x480 divided by one factor"},
  };
  for (const Refusal& refusal : refusals) {
    std::vector<std::string> arguments = {"simulate"};
    arguments.insert(arguments.end(), refusal.arguments.begin(), refusal.arguments.end());
    arguments.insert(arguments.end(), {"-o", output});
    const CommandOutcome outcome = run_pcavr(arguments);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_NE(outcome.standard_error.find(refusal.reason), std::string::npos)
        << outcome.standard_error;
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
}

TEST(Simulate, RejectsSizesOutOfTheirRange) {
  const std::vector<std::pair<std::string, std::string>> values = {
      {"--duration", "0"},          {"--duration", "nan"},
      {"--duration", "3601"},       {"--objects", "0"},
      {"--objects", "21"},          {"--frames-per-second", "inf"},
      {"--frames-per-second", "0"}, {"--image-size", "640"},
      {"--image-size", "0x480"},    {"--image-size", "99999x480"},
      {"--image-size", "640x480x3"}};
  for (const auto& [option, value] : values) {
    const CommandOutcome outcome = run_pcavr({"simulate", "tabletop", "-o", "x", option, value});
    EXPECT_EQ(outcome.exit_code, 2) << option << ' ' << value;
    EXPECT_NE(outcome.standard_error.find(option), std::string::npos) << outcome.standard_error;
    EXPECT_FALSE(fs::exists("x"));
  }
}

/// One numeric option, and an otherwise valid command line.
struct NumericOption {
  std::vector<std::string> command;
  const char* option;
};

std::vector<NumericOption> numeric_options() {
  const std::vector<std::string> build{"build", "r", "-o", "/nowhere/s"};
  const std::vector<std::string> replay{"replay", "r", "--scene", "s", "-o", "/nowhere/r"};
  const std::vector<std::string> import{"import", "r", "-o", "/nowhere/i"};
  const std::vector<std::string> simulate{"simulate", "push", "-o", "/nowhere/s", "--no-images"};
  const std::vector<std::string> serve{"serve", "s"};
  const std::vector<std::string> tags{"tags", "--ids", "0", "-o", "/nowhere/t.svg"};
  const std::vector<std::string> identify{"identify", "contact", "r", "-o", "/nowhere/p.yaml"};
  const std::vector<std::string> evaluate{"evaluate", "r", "-o", "/nowhere/e"};
  return {{build, "--voxel"},
          {build, "--occupancy-resolution"},
          {build, "--threads"},
          {replay, "--forward-delay"},
          {replay, "--backward-delay"},
          {replay, "--jitter"},
          {replay, "--loss"},
          {replay, "--seed"},
          {replay, "--threads"},
          {import, "--depth-scale"},
          {import, "--rate"},
          {import, "--stride"},
          {import, "--first"},
          {simulate, "--seed"},
          {simulate, "--clock-offset"},
          {simulate, "--saturate"},
          {simulate, "--threads"},
          {simulate, "--lose-tracking"},
          {serve, "--port"},
          {serve, "--rate"},
          {serve, "--tool-radius"},
          {serve, "--max-force"},
          {tags, "--size"},
          {tags, "--page-width"},
          {tags, "--page-height"},
          {identify, "--threads"},
          {evaluate, "--threads"}};
}

TEST(WrongUsage, IsEveryNumberThatIsNotFiniteOrOutOfRange) {
  for (const NumericOption& numeric : numeric_options()) {
    for (const char* value : {"nan", "inf", "-1e12"}) {
      std::vector<std::string> arguments = numeric.command;
      arguments.push_back(std::string(numeric.option) + '=' + value);
      const CommandOutcome outcome = run_pcavr(arguments);
      EXPECT_EQ(outcome.exit_code, 2) << arguments[0] << ' ' << arguments.back() << '\n'
                                      << outcome.standard_error;
      EXPECT_NE(outcome.standard_error.find(numeric.option), std::string::npos)
          << outcome.standard_error;
    }
  }
}

TEST(WrongUsage, IsANegativeSeedAndAnInvalidTagId) {
  EXPECT_EQ(run_pcavr({"simulate", "push", "-o", "/nowhere/s", "--seed", "-1"}).exit_code, 2);
  for (const char* ids : {"nan", "-1", "99999999999999999999", "3-1", "1;2", ""}) {
    EXPECT_NE(run_pcavr({"tags", "--ids", ids, "-o", "/nowhere/t.svg"}).exit_code, 0) << ids;
  }
}

TEST(WrongUsage, IsAJsonObjectWithJson) {
  const CommandOutcome outcome = run_pcavr({"build", "r", "--voxel", "nan", "-o", "s", "--json"});
  EXPECT_EQ(outcome.exit_code, 2);
  const auto json = nlohmann::json::parse(outcome.standard_output, nullptr, false);
  ASSERT_TRUE(json.contains("error")) << outcome.standard_output;
  EXPECT_EQ(json["error"]["exit_code"], 2);
  EXPECT_NE(json["error"]["message"].get<std::string>().find("--voxel"), std::string::npos);
}

TEST(Help, HasAnExampleForEverySubcommand) {
  for (const char* name :
       {"build", "replay", "evaluate", "simulate", "import", "inspect", "tags"}) {
    const CommandOutcome outcome = run_pcavr({name, "--help"});
    EXPECT_EQ(outcome.exit_code, 0) << name;
    EXPECT_NE(outcome.standard_output.find("Example:"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace pcavr
