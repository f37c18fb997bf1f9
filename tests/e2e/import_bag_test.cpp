// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The command on a small bag: listed, imported, and refused in one line; and what inspect says of
// logs.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "bag_import/bag_twin.hpp"
#include "support/json_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

TEST(ImportBagCommand, ListsImportsAndRefuses) {
  const TemporaryFolder folder;
  const std::string bag = (folder.path() / "twin.mcap").string();
  const std::string target = (folder.path() / "recording").string();
  test::BagTwin::write_mcap(bag, test::BagTwin::messages(RosEncoder::Format::cdr));
  const nlohmann::json listed = run_json({"inspect", bag});
  ASSERT_EQ(listed["topics"].size(), 8U);
  for (const nlohmann::json& topic : listed["topics"]) EXPECT_NE(topic["taken_for"], "") << topic;
  const CommandOutcome refused = run_pcavr({"import", bag, "--tool-topic", "/typ", "-o", target});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_EQ(refused.error_lines(), 1U) << refused.standard_error;
  EXPECT_FALSE(std::filesystem::exists(target));
  const nlohmann::json imported =
      run_json({"import", bag, "--tool-frame", "tip", "--base-frame", "base_link", "-o", target});
  EXPECT_EQ(imported["streams"].size(), 6U);
  EXPECT_TRUE(run_json({"inspect", target})["is_sound"].get<bool>());
}

TEST(InspectCommand, NamesABagOfAFolderOfBags) {
  const TemporaryFolder folder;
  const std::string bag = (folder.path() / "a.bag").string();
  std::ofstream(bag) << "#ROSBAG V2.0\n";
  std::ofstream(folder.path() / "b.bag") << "#ROSBAG V2.0\n";
  const CommandOutcome outcome = run_pcavr({"inspect", folder.path().string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
  EXPECT_NE(outcome.standard_error.find("it holds bags: give one, such as " + bag),
            std::string::npos)
      << outcome.standard_error;
}

// `inspect` reports what an imported log of a robot lacks before another command stops at it.
TEST(InspectCommand, NamesObjectsWithoutMeshAndJointsOfAnotherRobot) {
  const TemporaryFolder folder;
  const auto write = [&](const char* file, const std::string& text) {
    std::ofstream(folder.path() / file) << text;
  };
  write("recording.yaml",
        "format: pcavr-recording/1\nobjects: [{name: box}]\nrobot: {urdf: arm.urdf}\n");
  write("arm.urdf", R"(<robot name="arm"><link name="base"/><link name="tip"/>
    <joint name="joint_1" type="continuous">
      <parent link="base"/><child link="tip"/><axis xyz="0 0 1"/></joint></robot>)");
  write("joints.csv", "t,q_Joint1\n0.0,0.1\n0.1,0.2\n");
  const CommandOutcome sound = run_pcavr({"inspect", folder.path().string()});
  EXPECT_EQ(sound.exit_code, 0) << sound.standard_error;
  EXPECT_NE(sound.standard_output.find("box: warning: no CAD mesh"), std::string::npos)
      << sound.standard_output;
  write("joints.csv", "t,q_wrist\n0.0,0.1\n0.1,0.2\n");
  const CommandOutcome other = run_pcavr({"inspect", folder.path().string()});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_EQ(other.error_lines(), 1U) << other.standard_error;
  EXPECT_NE(other.standard_error.find("no movable joint 'wrist'"), std::string::npos)
      << other.standard_error;
}

}  // namespace
}  // namespace pcavr
