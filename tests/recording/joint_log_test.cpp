// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/joint_log.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/import_joint_log.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

Expected<Series<JointLog>> parse(std::string_view text) {
  return parse_joint_log({.file = "joints.csv", .text = text});
}

TEST(JointLog, ReadsColumnsByNameInAnyOrder) {
  const auto log = parse("t,tau_b,q_a,q_b,tau_a,tau_ext_a\n1.5,1,2,3,4,9\n1.6,5,6,7,8,9\n");
  ASSERT_TRUE(log) << log.error().to_string();
  const JointLog& content = log->content;
  EXPECT_EQ(content.joints, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(content.position(0, 0), 2.0);
  EXPECT_EQ(content.torque(0, 0), 4.0);
  EXPECT_EQ(content.torque(1, 1), 5.0);
  EXPECT_EQ(content.velocity.rows(), 0);
  EXPECT_EQ(content.unused, std::vector<std::string>{"tau_ext_a"});
  EXPECT_NEAR(content.t[1], 0.1, 1e-9);
  EXPECT_EQ(content.lines[1], 3);
}

TEST(JointLog, WritesWhatItReads) {
  const std::string text =
      "t,q_1,q_2,dq_1,dq_2,current_1,current_2\n0.250000000,0.1,-2,3,4.5,1e-07,6\n";
  const auto log = parse(text);
  ASSERT_TRUE(log);
  EXPECT_EQ(format_joint_log(log->content), text);
}

TEST(JointLog, NamesWhatTheHeaderLacks) {
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"q_1,t\n", "first column"},
           {"t,tau_1\n", "no position column"},
           {"t,q_1,tau_2\n", "no position column for joint '2'"},
           {"t,q_1,q_2,tau_1\n", "no column tau_2"},
           {"t,q_1,q1\n", "occurs twice"}}) {
    const auto log = parse(text);
    ASSERT_FALSE(log) << text;
    EXPECT_NE(log.error().message.find(part), std::string::npos) << log.error().to_string();
  }
}

TEST(ImportJointLog, ReadsRowsWithoutDesiredValues) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "log.csv";
  ASSERT_TRUE(write_file(file, "0.1,1,2,3,4,5,6\n0.2,1,2,3,4,7,8\n"));
  ASSERT_TRUE(has_joint_log(file));
  const auto imported = import_joint_log(file, {});
  ASSERT_TRUE(imported) << imported.error().to_string();
  ASSERT_EQ(imported->log.joints.size(), 2U);
  EXPECT_EQ(imported->log.velocity(1, 1), 4.0);
  EXPECT_EQ(imported->log.current(1, 1), 8.0);
}

TEST(ImportJointLog, ReadsRowsWithoutHeader) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "log.csv";
  ASSERT_TRUE(write_file(file,
                         "10.0,1,2,3,4,5,6,7,8,9,10\n10.1,2,2,3,4,5,6,7,8,9,10\n"
                         "10.1,9,9,9,9,9,9,9,9,9,9\n"));
  EXPECT_TRUE(has_joint_log(file));
  const auto imported = import_joint_log(file, {});
  ASSERT_TRUE(imported) << imported.error().to_string();
  EXPECT_EQ(imported->log.joints.size(), 2U);
  EXPECT_EQ(imported->log.velocity(0, 0), 3.0);
  EXPECT_EQ(imported->log.current(0, 1), 6.0);
  EXPECT_EQ(imported->left_out, 1U);
}

TEST(ImportJointLog, SkipsRowsThatCannotBeReadWhereAsked) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "log.csv";
  ASSERT_TRUE(write_file(file,
                         "10.0,1,2,3,4,5,6\n10.1,1e300,2,3,4,5,6\n10.1,2\n"
                         "10.2,2,2,3,4,5,6\n"));
  const auto refused = import_joint_log(file, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().line, 2);
  EXPECT_NE(refused.error().hint.find("--skip-bad"), std::string::npos);
  const auto imported = import_joint_log(file, {.skip_bad = true});
  ASSERT_TRUE(imported) << imported.error().to_string();
  EXPECT_EQ(imported->log.t.size(), 2U);
  EXPECT_EQ(imported->bad, 2U);
}

TEST(ImportJointLog, ReadsFilesOfOneNumberALine) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder.path() / "a_positions.txt", "1\n2\n3\n4\n"));
  ASSERT_TRUE(write_file(folder.path() / "a_torques.txt", "5\n6\n7\n8\n"));
  ASSERT_TRUE(write_file(folder.path() / "a_time.txt", "0\n0.5\n"));
  const auto imported = import_joint_log(folder.path(), {});
  ASSERT_TRUE(imported) << imported.error().to_string();
  EXPECT_EQ(imported->log.position(1, 0), 3.0);
  EXPECT_EQ(imported->log.torque(0, 1), 6.0);
  EXPECT_EQ(imported->log.velocity.rows(), 0);
}

TEST(ImportJointLog, NeedsThePeriodWhereThereAreNoStamps) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "log.csv";
  ASSERT_TRUE(write_file(file, "q_0,tau_0\n1,2\n3,4\n"));
  const auto without = import_joint_log(file, {});
  ASSERT_FALSE(without);
  EXPECT_NE(without.error().hint.find("--period"), std::string::npos);
  const auto imported = import_joint_log(file, {.period = 0.02});
  ASSERT_TRUE(imported) << imported.error().to_string();
  EXPECT_NEAR(imported->log.t[1], 0.02, 1e-9);
}

}  // namespace
}  // namespace pcavr
