// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// --config and --print-config of the real command.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/command.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

const std::vector<std::vector<std::string>> kCommands = {{"build"},
                                                         {"identify", "contact"},
                                                         {"identify", "friction"},
                                                         {"replay"},
                                                         {"evaluate"},
                                                         {"simulate"},
                                                         {"import"},
                                                         {"serve"},
                                                         {"inspect"},
                                                         {"tags"}};

CommandOutcome run(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_pcavr(arguments);
}

class ConfigurationCommand : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    const fs::path file = folder_.path() / "options.yaml";
    EXPECT_TRUE(write_file(file, text));
    return file.string();
  }

  TemporaryFolder folder_;
};

TEST_F(ConfigurationCommand, EveryCommandReadsTheOptionsOfAll) {
  const CommandOutcome defaults = run_pcavr({"--print-config"});
  ASSERT_EQ(defaults.exit_code, 0) << defaults.standard_error;
  const std::string file = write(defaults.standard_output);
  for (const std::vector<std::string>& command : kCommands) {
    const CommandOutcome printed = run(command, {"--print-config", "--config", file});
    EXPECT_EQ(printed.exit_code, 0) << command[0] << ": " << printed.standard_error;
  }
}

TEST_F(ConfigurationCommand, TheCommandLineWinsOverTheFile) {
  const std::string file =
      write("reconstruction.fusion: {voxel_size: 0.02}\nscene.occupancy: {resolution: 0.5}\n");
  for (const std::vector<std::string>& order :
       {std::vector<std::string>{"--voxel", "0.03", "--config", file},
        std::vector<std::string>{"--config", file, "--voxel", "0.03"}}) {
    const CommandOutcome printed = run({"build", "--print-config"}, order);
    ASSERT_EQ(printed.exit_code, 0) << printed.standard_error;
    EXPECT_NE(printed.standard_output.find("\n  voxel_size: 0.03\n"), std::string::npos);
    EXPECT_NE(printed.standard_output.find("\n  resolution: 0.5\n"), std::string::npos);
  }
}

TEST_F(ConfigurationCommand, RejectsABadFileBeforeAnyWork) {
  const std::string file = write("\nreconstruction.fusion:\n  voxel_size: 5\n");
  for (const std::vector<std::string>& command : kCommands) {
    const CommandOutcome outcome = run(command, {"--print-config", "--config", file});
    EXPECT_EQ(outcome.exit_code, 1) << command[0];
    EXPECT_EQ(outcome.standard_error,
              "pcavr: " + file +
                  ":3: reconstruction.fusion.voxel_size: 5 is out of range; write a number from "
                  "0.001 to 0.1 m\n");
  }
}

TEST_F(ConfigurationCommand, AChangedOptionChangesTheSceneAndIsRecorded) {
  const std::string recording = (folder_.path() / "recording").string();
  const CommandOutcome simulated = run_pcavr(
      {"simulate", "tabletop", "-o", recording, "--duration", "1", "--frames-per-second", "8"});
  ASSERT_EQ(simulated.exit_code, 0) << simulated.standard_error;
  const auto build = [&](const std::string& name, const std::vector<std::string>& more) {
    const fs::path scene = folder_.path() / name;
    const CommandOutcome outcome =
        run({"build", recording, "-o", scene.string(), "--voxel", "0.02"}, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
    return scene;
  };
  const std::string file = write("reconstruction.fusion: {truncation_voxels: 2.5}\n");
  const fs::path usual = build("usual", {});
  const fs::path changed = build("changed", {"--config", file});
  EXPECT_NE(read_file(usual / "mesh.ply").value(), read_file(changed / "mesh.ply").value());
  const std::string recorded = read_file(changed / "scene.yaml").value();
  EXPECT_NE(recorded.find("reconstruction.fusion.truncation_voxels: 2.5"), std::string::npos);
  EXPECT_EQ(read_file(usual / "scene.yaml").value().find("truncation_voxels"), std::string::npos);
  EXPECT_EQ(run_pcavr({"inspect", changed.string()}).exit_code, 0);
}

}  // namespace
}  // namespace pcavr
