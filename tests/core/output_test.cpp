// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/core/output.hpp"

#include <utility>

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(OutputFolder, AppearsWholeAtItsCommit) {
  const TemporaryFolder parent;
  const fs::path target = parent.path() / "scene";
  Expected<OutputFolder> folder = OutputFolder::create(target);
  ASSERT_TRUE(folder);
  ASSERT_TRUE(write_file(folder->path() / "a.txt", "a"));
  EXPECT_FALSE(fs::exists(target));
  ASSERT_TRUE(folder->commit());
  EXPECT_EQ(*read_file(target / "a.txt"), "a");
  EXPECT_EQ(entries(parent.path()), 1u);
}

TEST(OutputFolder, LeavesNothingWithoutACommit) {
  const TemporaryFolder parent;
  {
    const Expected<OutputFolder> folder = OutputFolder::create(parent.path() / "scene/");
    ASSERT_TRUE(folder);
  }
  EXPECT_EQ(entries(parent.path()), 0u);
}

TEST(OutputFolder, IsNotRemovedByTheOneMovedFrom) {
  const TemporaryFolder parent;
  Expected<OutputFolder> first = OutputFolder::create(parent.path() / "scene");
  ASSERT_TRUE(first);
  OutputFolder second = *std::move(first);
  EXPECT_TRUE(fs::exists(second.path()));
  EXPECT_TRUE(second.commit());
}

TEST(OutputFolder, ReplacesOnlyWhereTold) {
  const TemporaryFolder parent;
  const fs::path target = parent.path() / "scene";
  fs::create_directory(target);
  ASSERT_TRUE(write_file(target / "old.txt", "old"));
  EXPECT_FALSE(OutputFolder::create(target));
  Expected<OutputFolder> folder = OutputFolder::create(target, true);
  ASSERT_TRUE(folder);
  EXPECT_TRUE(fs::exists(target / "old.txt")) << "kept until the commit";
  ASSERT_TRUE(folder->commit());
  EXPECT_EQ(entries(target), 0u);
}

TEST(OutputFolder, RefusesAFileInItsPlace) {
  const TemporaryFolder parent;
  ASSERT_TRUE(write_file(parent.path() / "file", ""));
  EXPECT_FALSE(OutputFolder::create(parent.path() / "file", true));
  EXPECT_FALSE(OutputFolder::create(parent.path() / "file/below"));
}

TEST(WriteFile, ReplacesAFileAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.txt";
  ASSERT_TRUE(write_file(file, "long content"));
  ASSERT_TRUE(write_file(file, std::string("s\0rt", 4)));
  EXPECT_EQ(*read_file(file), std::string("s\0rt", 4));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(WriteFile, SaysWhereItCanNot) {
  const TemporaryFolder folder;
  const Expected<void> written = write_file(folder.path() / "absent/a.txt", "a");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().file, (folder.path() / "absent/a.txt").string());
}

TEST(WriteFile, ReportsAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  const TemporaryFolder folder;
  // The temporary name stands beside the target, so the full device is reached through a link.
  const fs::path partial = folder.path() / (".a.partial-" + std::to_string(::getpid()));
  fs::create_symlink("/dev/full", partial);
  const Expected<void> written = write_file(folder.path() / "a", "content");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("space"), std::string::npos);
  EXPECT_EQ(entries(folder.path()), 0u);
}

TEST(ReadFile, RefusesFoldersAndAbsentFiles) {
  const TemporaryFolder folder;
  EXPECT_FALSE(read_file(folder.path()));
  EXPECT_FALSE(read_file(folder.path() / "absent"));
}

TEST(ReadFile, ReadsFilesThatTellNoSize) {
  if (!fs::exists("/proc/self/status")) GTEST_SKIP() << "needs /proc";
  EXPECT_FALSE(read_file("/proc/self/status")->empty());
}

}  // namespace
}  // namespace pcavr
