// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Help, suggestions, colours and exit codes of the real command, without a terminal and on one.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/command.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

/// What the command prints, output and errors, on a terminal of this many columns.
std::string run_on_terminal(const std::vector<std::string>& arguments, unsigned short columns,
                            const char* no_color) {
  winsize size{};
  size.ws_row = 24;
  size.ws_col = columns;
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    ::setenv("TERM", "xterm", 1);
    ::setenv("NO_COLOR", no_color, 1);
    ::unsetenv("COLUMNS");
    std::vector<char*> words{const_cast<char*>(PCAVR_COMMAND)};
    for (const std::string& argument : arguments)
      words.push_back(const_cast<char*>(argument.data()));
    words.push_back(nullptr);
    ::execv(PCAVR_COMMAND, words.data());
    ::_exit(127);
  }
  std::string printed;
  std::array<char, 4096> buffer{};
  for (ssize_t count = 0; (count = ::read(terminal, buffer.data(), buffer.size())) > 0;) {
    printed.append(buffer.data(), static_cast<std::size_t>(count));
  }
  ::close(terminal);
  ::waitpid(child, nullptr, 0);
  return printed;
}

/// The longest line, except for examples, which stay whole, to be copied.
std::size_t longest_line(const std::string& help) {
  std::size_t longest = 0;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (!line.starts_with("  pcavr ")) longest = std::max(longest, line.size());
  }
  return longest;
}

TEST(Help, IsWrappedAt80ColumnsAndAtTheTerminalsWidth) {
  const std::vector<std::string> help{"robot-site", "--help"};
  const std::string piped = run_pcavr(help, "env -u COLUMNS ").standard_output;
  EXPECT_LE(longest_line(piped), 80U) << piped;
  EXPECT_GT(longest_line(piped), 70U) << piped;
  const std::string narrow = run_on_terminal(help, 60, "1");
  EXPECT_LE(longest_line(narrow), 60U) << narrow;
  const std::string wide = run_pcavr(help, "COLUMNS=120 ").standard_output;
  EXPECT_LE(longest_line(wide), 120U) << wide;
  EXPECT_GT(longest_line(wide), 100U) << wide;
}

TEST(Help, HasColoursOnATerminalOnly) {
  const std::vector<std::string> help{"help", "tags"};
  EXPECT_NE(run_on_terminal(help, 80, "").find("\033[1mOptions:"), std::string::npos);
  EXPECT_EQ(run_on_terminal(help, 80, "1").find('\033'), std::string::npos);
  EXPECT_EQ(run_pcavr(help).standard_output.find('\033'), std::string::npos);
  EXPECT_NE(run_on_terminal({"inspect", "/nowhere"}, 80, "").find("\033[31mpcavr:"),
            std::string::npos);
}

TEST(Help, OfEveryCommandHasTheOptionsOfConfiguration) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"help", "build"}, {"help", "identify", "friction"}}) {
    const std::string help = run_pcavr(words).standard_output;
    for (const char* option : {"--config", "--print-config", "--json"}) {
      EXPECT_NE(help.find(option), std::string::npos) << words.back() << ' ' << option;
    }
  }
}

TEST(WrongUsage, NamesTheOptionThatWasProbablyMeant) {
  const CommandOutcome own = run_pcavr({"build", "r", "-o", "s", "--voxle", "0.01"});
  EXPECT_EQ(own.exit_code, 2);
  EXPECT_EQ(own.standard_error,
            "pcavr: unknown option '--voxle'; did you mean --voxel? see pcavr build --help\n");
  const CommandOutcome common = run_pcavr({"identify", "friction", "--print-confg"});
  EXPECT_NE(common.standard_error.find("did you mean --print-config?"), std::string::npos)
      << common.standard_error;
  const CommandOutcome nested = run_pcavr({"identify", "frction"});
  EXPECT_NE(nested.standard_error.find("did you mean friction?"), std::string::npos)
      << nested.standard_error;
}

TEST(PrintedConfiguration, HasWhatTheCommandUses) {
  const auto has = [](const std::vector<std::string>& words, const std::string& section) {
    std::vector<std::string> arguments = words;
    arguments.emplace_back("--print-config");
    const CommandOutcome outcome = run_pcavr(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
    return ('\n' + outcome.standard_output).find('\n' + section + ":\n") != std::string::npos;
  };
  EXPECT_TRUE(has({"build"}, "reconstruction.fusion"));
  EXPECT_FALSE(has({"build"}, "serve.network"));
  EXPECT_TRUE(has({"serve"}, "serve.network"));
  EXPECT_TRUE(has({"identify", "robot"}, "robot_identification.fit"));
  EXPECT_FALSE(has({"identify", "friction"}, "robot_identification.fit"));
  EXPECT_FALSE(has({"tags"}, "recording"));
}

/// Otherwise the option of a new section would be found nowhere but in the list of all.
TEST(PrintedConfiguration, HasEachSectionAtSomeCommand) {
  const std::string all = run_pcavr({"--print-config"}).standard_output;
  std::string used;
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"build"},
                                             {"identify", "friction"},
                                             {"identify", "robot"},
                                             {"predict"},
                                             {"record"},
                                             {"evaluate"},
                                             {"serve"},
                                             {"robot-site"},
                                             {"operator-site"}}) {
    std::vector<std::string> words = command;
    words.emplace_back("--print-config");
    used += '\n' + run_pcavr(words).standard_output;
  }
  std::istringstream lines(all);
  std::size_t sections = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == ' ' || line[0] == '#') continue;
    ++sections;
    EXPECT_NE(used.find('\n' + line + '\n'), std::string::npos) << line;
  }
  EXPECT_GT(sections, 50U);
}

TEST(PrintedConfiguration, IsReadBackByTheCommand) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "options.yaml").string();
  const CommandOutcome printed = run_pcavr({"inspect", "--print-config"});
  ASSERT_TRUE(write_file(file, printed.standard_output));
  EXPECT_EQ(run_pcavr({"inspect", "--print-config", "--config", file}).standard_output,
            printed.standard_output);
}

TEST(Predict, ExitsWithThreeWhereTheAnswerIsNo) {
  const auto reach = [](const char* x) {
    return run_pcavr({"predict", "reach", "--robot",
                      (source_folder() / "calib/robots/pa10/pa10.urdf").string(), "--point", x,
                      "0.15", "0.55"});
  };
  const CommandOutcome yes = reach("0.65");
  EXPECT_EQ(yes.exit_code, 0) << yes.standard_error;
  const CommandOutcome no = reach("9");
  EXPECT_EQ(no.exit_code, 3) << no.standard_error;
  EXPECT_TRUE(no.standard_output.starts_with("no: ")) << no.standard_output;
}

TEST(Inspect, GivesNumbersAsNumbersWithJson) {
  const TemporaryFolder folder;
  const std::string recording = (folder.path() / "recording").string();
  ASSERT_EQ(run_pcavr({"simulate", "paper", "--no-images", "-o", recording}).exit_code, 0);
  const CommandOutcome outcome = run_pcavr({"inspect", recording, "--json"});
  const auto json = nlohmann::json::parse(outcome.standard_output, nullptr, false);
  ASSERT_TRUE(json.contains("values")) << outcome.standard_output;
  EXPECT_EQ(json["values"]["objects"], 2);
  EXPECT_GT(json["values"]["wrench.csv"]["samples"].get<int>(), 1000);
  EXPECT_GT(json["values"]["tool.csv"]["duration_s"].get<double>(), 1.0);
}

}  // namespace
}  // namespace pcavr
