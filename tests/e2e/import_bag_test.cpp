// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The command on a small bag: listed, imported, and refused in one line.
#include <filesystem>
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

}  // namespace
}  // namespace pcavr
