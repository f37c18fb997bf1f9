// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/output_file.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include "pcavr/base/core/output.hpp"

#include "support/file_tree.hpp"
#include "support/forked.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

const OutputFileOptions kReplaceOurs{
    .replace = true, .kind = "parameter file", .is_replaceable = [](const fs::path& file) {
      return *read_file(file) == "ours";
    }};

class OutputFileTest : public testing::Test {
 protected:
  [[nodiscard]] fs::path path_of(const std::string& name) const { return folder_.path() / name; }

  TemporaryFolder folder_;
};

TEST_F(OutputFileTest, AppearsAtomicallyAtItsCommit) {
  {
    Expected<OutputFile> file = OutputFile::create(path_of("a.mp4"), {});
    ASSERT_TRUE(file);
    EXPECT_EQ(file->path().extension(), ".mp4");
    ASSERT_TRUE(file->write("longer"));
    ASSERT_TRUE(file->write("whole"));
    EXPECT_FALSE(fs::exists(path_of("a.mp4")));
    ASSERT_TRUE(file->commit());
  }
  EXPECT_EQ(tree(folder_.path()), (FileTree{{"a.mp4", "whole"}}));
}

TEST_F(OutputFileTest, LeavesNothingWithoutACommit) {
  {
    Expected<OutputFile> file = OutputFile::create(path_of("a.yaml"), {});
    ASSERT_TRUE(file->write("half"));
  }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(OutputFileTest, ReplacesOnlyItsOwnKindAndOnlyWhereAsked) {
  write_tree(folder_.path(), {{"ours", "ours"}, {"mine", "mine"}, {"empty", ""}});
  EXPECT_FALSE(OutputFile::create(path_of("ours"), {}));
  EXPECT_TRUE(OutputFile::check(path_of("ours"), kReplaceOurs));
  EXPECT_TRUE(OutputFile::check(path_of("empty"), kReplaceOurs));
  const Expected<void> refused = OutputFile::check(path_of("mine"), kReplaceOurs);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("parameter file"), std::string::npos);
  {
    Expected<OutputFile> file = OutputFile::create(path_of("ours"), kReplaceOurs);
    ASSERT_TRUE(file->write("new"));
    ASSERT_TRUE(file->commit());
  }
  EXPECT_EQ(tree(folder_.path()), (FileTree{{"ours", "new"}, {"mine", "mine"}, {"empty", ""}}));
}

TEST_F(OutputFileTest, UndoRevertsACommit) {
  write_tree(folder_.path(), {{"old", "ours"}});
  for (const char* name : {"old", "new"}) {
    Expected<OutputFile> file = OutputFile::create(path_of(name), kReplaceOurs);
    ASSERT_TRUE(file->write("new"));
    ASSERT_TRUE(file->commit());
    file->undo();
  }
  EXPECT_EQ(tree(folder_.path()), (FileTree{{"old", "ours"}}));
}

TEST_F(OutputFileTest, RefusesPathsThatAreNotRegularFiles) {
  ASSERT_EQ(::mkfifo(path_of("fifo").c_str(), 0600), 0);
  fs::create_directory(path_of("folder"));
  fs::create_symlink("loop", path_of("loop"));
  for (const fs::path& target :
       {path_of("fifo"), path_of("folder"), path_of("folder/"), fs::path("/dev/null"), fs::path(),
        path_of("loop"), path_of("absent/a"), path_of(std::string(300, 'n'))}) {
    const Expected<void> checked = OutputFile::check(target, kReplaceOurs);
    EXPECT_FALSE(checked) << target;
    EXPECT_FALSE(OutputFile::create(target, kReplaceOurs)) << target;
  }
}

TEST_F(OutputFileTest, RefusesAMountPointBeforeWriting) {
  write_tree(folder_.path(), {{"host", "ours"}, {"mounted", ""}});
  const int code = run_forked([&] {
    if (::unshare(CLONE_NEWNS) != 0 || ::mount(path_of("host").c_str(), path_of("mounted").c_str(),
                                               nullptr, MS_BIND, nullptr) != 0) {
      return kForkedSkip;
    }
    return OutputFile::check(path_of("mounted"), kReplaceOurs) ? 1 : 0;
  });
  if (code == kForkedSkip) GTEST_SKIP() << "may not mount here";
  EXPECT_EQ(code, 0);
}

TEST_F(OutputFileTest, WritesThroughASymbolicLink) {
  fs::create_directory(path_of("disk"));
  fs::create_symlink("disk/a", path_of("link"));
  {
    Expected<OutputFile> file = OutputFile::create(path_of("link"), {});
    ASSERT_TRUE(file->write("a"));
    ASSERT_TRUE(file->commit());
  }
  EXPECT_EQ(tree(folder_.path()), (FileTree{{"disk/a", "a"}, {"link", "-> disk/a"}}));
}

TEST_F(OutputFileTest, RemovesWhatADeadProcessLeft) {
  const std::string dead = std::to_string(id_of_dead_process());
  write_tree(folder_.path(), {{".a.mp4.partial-" + dead + ".mp4", "half"},
                              {".a.mp4.partial-" + dead, "a folder's: not of this name"}});
  EXPECT_TRUE(OutputFile::create(path_of("a.mp4"), {}));
  EXPECT_EQ(tree(folder_.path()).size(), 1U);
}

}  // namespace
}  // namespace pcavr
