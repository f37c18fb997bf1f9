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

#include "pcavr/base/core/utf8.hpp"

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
  EXPECT_EQ(unknown.standard_error,
            "pcavr: unknown command 'biuld'; did you mean build? see pcavr --help\n");
}

TEST(WrongUsage, NamesAnUnknownCommandAlsoWhereHelpIsAskedFor) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"buld", "--help"}, {"--help", "buld"}, {"--json", "buld"}, {"buld", "-h"}}) {
    const CommandOutcome unknown = run_pcavr(words);
    EXPECT_EQ(unknown.exit_code, 2) << words[0];
    EXPECT_NE(unknown.standard_error.find("did you mean build?"), std::string::npos) << words[0];
  }
  const CommandOutcome other = run_pcavr({"frobnicate", "--help"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_EQ(other.standard_error.find("did you mean"), std::string::npos);
  EXPECT_EQ(run_pcavr({"--help"}).exit_code, 0);
  EXPECT_EQ(run_pcavr({"build", "--help"}).exit_code, 0);
  EXPECT_EQ(run_pcavr({"--version"}).exit_code, 0);
  EXPECT_EQ(run_pcavr({"-v"}).standard_output, run_pcavr({"--version"}).standard_output);
  const CommandOutcome help = run_pcavr({"help", "identify", "friction"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.standard_output, run_pcavr({"identify", "friction", "--help"}).standard_output);
  EXPECT_EQ(run_pcavr({"help"}).standard_output, run_pcavr({"--help"}).standard_output);
  EXPECT_EQ(run_pcavr({"help", "biuld"}).exit_code, 2);
}

/// Descriptors that are closed at the start must not become those of the outputs.
TEST(ClosedDescriptors, LeaveTheOutputsAsTheyAre) {
  const TemporaryFolder folder;
  const auto simulate = [&folder](const std::string& name, const std::string& prefix) {
    const std::string output = (folder.path() / name).string();
    return run_pcavr({"simulate", "paper", "--no-images", "-o", output}, prefix).exit_code;
  };
  ASSERT_EQ(simulate("usual", ""), 0);
  for (const std::string closed : {"<&-", "2>&-", ">&-", "<&- >&- 2>&-"}) {
    const std::string name = "closed" + std::to_string(closed.size()) + closed[0];
    ASSERT_EQ(simulate(name, "sh -c 'exec \"$0\" \"$@\" " + closed + "' "), 0) << closed;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path() / "usual")) {
      if (!entry.is_regular_file()) continue;
      const fs::path file = fs::relative(entry.path(), folder.path() / "usual");
      EXPECT_EQ(read_file(folder.path() / name / file).value(), read_file(entry.path()).value())
          << closed << ' ' << file;
    }
  }
}

TEST(Tags, AreAtMostAThousand) {
  const TemporaryFolder folder;
  const std::string output = (folder.path() / "sheet.svg").string();
  std::string many = "0";
  for (int id = 1; id < 20'000; ++id) many += "," + std::to_string(id);
  for (const std::string& ids :
       {many, std::string("0-1000"), std::string("0-999,5"), std::string("0-2000000000")}) {
    const CommandOutcome outcome = run_pcavr({"tags", "--ids", ids, "-o", output});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.standard_error.find("more than 1000 tag ids"), std::string::npos);
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
}

/// A terminal would act on them.
TEST(ControlCharacters, AreNeverPrinted) {
  const TemporaryFolder folder;
  const fs::path recording = folder.path() / "re\x1b[2Jcording";
  fs::create_directories(recording);
  ASSERT_TRUE(write_file(recording / "recording.yaml",
                         "format: \"pcavr-recording/1\\e]0;x\\a\\u202e\\x9b\\x7f\"\n"));
  const CommandOutcome outcome = run_pcavr({"inspect", recording.string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines(), 1U);
  EXPECT_FALSE(has_controls(outcome.standard_error.substr(0, outcome.standard_error.size() - 1)))
      << printable(outcome.standard_error);
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
