// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/output.hpp"

#include <csignal>
#include <fstream>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>

#include "support/file_tree.hpp"
#include "support/forked.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

constexpr OutputFolderOptions kReplaceScene{.kind = OutputKind::scene, .replace = true};

void write_scene(const fs::path& folder, const std::string& text) {
  fs::create_directories(folder / "lod");
  ASSERT_TRUE(write_file(folder / "scene.yaml", "format: pcavr-scene/1\nname: " + text + "\n"));
  ASSERT_TRUE(write_file(folder / "mesh.ply", text));
  ASSERT_TRUE(write_file(folder / "lod/static_mesh_1.glb", text));
}

/// A folder as a run of that process leaves it when it is killed.
fs::path left_by(const fs::path& parent, const std::string& name, long process) {
  const fs::path left = parent / ("." + name + ".partial-" + std::to_string(process));
  fs::create_directory(left);
  std::ofstream(left / "half.ply") << "half";
  return left;
}

TEST(OutputFolder, AppearsAtomicallyAtItsCommit) {
  const TemporaryFolder parent;
  const fs::path target = parent.path() / "scene";
  Expected<OutputFolder> folder = OutputFolder::create(target);
  ASSERT_TRUE(folder);
  ASSERT_TRUE(write_file(folder->path() / "a.txt", "a"));
  EXPECT_FALSE(fs::exists(target));
  ASSERT_TRUE(folder->commit());
  EXPECT_EQ(tree(parent.path()), (FileTree{{"scene/a.txt", "a"}}));
}

TEST(OutputFolder, ReplacesNoFolderWithFilesThatItsManifestDoesNotName) {
  const TemporaryFolder parent;
  const fs::path target = parent.path() / "scene";
  const auto check = [&] { return OutputFolder::create(target, kReplaceScene).has_value(); };
  write_scene(target, "objects:\n  - name: box\n  - {name: \"two words\", mass: 1}\n");
  fs::create_directories(target / "objects");
  ASSERT_TRUE(write_file(target / "objects/box.glb", "box"));
  ASSERT_TRUE(write_file(target / "objects/two words.glb", "box"));
  ASSERT_TRUE(write_file(target / "lod/static_mesh_12.glb", "level"));
  EXPECT_TRUE(check());
  for (const char* name : {"objects/precious.txt", "objects/precious.glb", "lod/notes.md",
                           "objects/deep/er/thesis.pdf", "lod/static_mesh_x.glb",
                           "lod/static_mesh_1.glb.bak", "objects/.hidden"}) {
    fs::create_directories((target / name).parent_path());
    ASSERT_TRUE(write_file(target / name, "mine"));
    const auto refused = OutputFolder::create(target, kReplaceScene);
    ASSERT_FALSE(refused) << name;
    EXPECT_NE(refused.error().message.find(name), std::string::npos) << refused.error().message;
    fs::remove(target / name);
  }
  fs::create_symlink("/etc", target / "objects/link");
  EXPECT_FALSE(check());
  fs::remove(target / "objects/link");
  EXPECT_TRUE(check());
}

TEST(OutputFolder, LeavesNothingWithoutACommit) {
  const TemporaryFolder parent;
  {
    const Expected<OutputFolder> folder = OutputFolder::create(parent.path() / "new/below/scene/");
    ASSERT_TRUE(folder);
    ASSERT_TRUE(write_file(folder->path() / "a.txt", "a"));
  }
  EXPECT_TRUE(fs::is_empty(parent.path()));
}

TEST(OutputFolder, IsNotRemovedByTheOneMovedFrom) {
  const TemporaryFolder parent;
  Expected<OutputFolder> first = OutputFolder::create(parent.path() / "scene");
  ASSERT_TRUE(first);
  OutputFolder second = *std::move(first);
  EXPECT_TRUE(fs::exists(second.path()));
  EXPECT_TRUE(second.commit());
}

TEST(OutputFolder, ReplacesAnOutputOfItsKindWhereAsked) {
  const TemporaryFolder parent;
  const fs::path target = parent.path() / "scene";
  write_scene(target, "old");
  const Expected<OutputFolder> refused = OutputFolder::create(target);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().hint.find("--force"), std::string::npos);
  Expected<OutputFolder> folder = OutputFolder::create(target, kReplaceScene);
  ASSERT_TRUE(folder);
  EXPECT_EQ(*read_file(target / "mesh.ply"), "old") << "kept until the commit";
  write_scene(folder->path(), "new");
  fs::remove_all(folder->path() / "lod");
  ASSERT_TRUE(folder->commit());
  EXPECT_EQ(*read_file(target / "mesh.ply"), "new");
  EXPECT_FALSE(fs::exists(target / "lod"));
  EXPECT_EQ(tree(parent.path()).size(), 2U);
}

TEST(OutputFolder, NeverReplacesWhatIsNotAnOutputOfItsKind) {
  const TemporaryFolder parent;
  const std::vector<std::pair<std::string, FileTree>> cases{
      {"an unrelated folder", {{"thesis.tex", "years"}}},
      {"a name alone", {{"scene.yaml", "format: other-scene/1\n"}}},
      {"a format in a value", {{"scene.yaml", "note: 'format: pcavr-scene/1'\n"}}},
      {"another kind", {{"run.yaml", "format: pcavr-run/1\n"}}},
      {"a scene among other things", {{"scene.yaml", "format: pcavr-scene/1\n"}, {"notes", "n"}}},
      {"a folder above a scene", {{"scene/scene.yaml", "format: pcavr-scene/1\n"}}}};
  for (const auto& [name, content] : cases) {
    const fs::path target = parent.path() / name;
    write_tree(target, content);
    const Expected<OutputFolder> folder = OutputFolder::create(target, kReplaceScene);
    EXPECT_FALSE(folder) << name;
    EXPECT_EQ(tree(target), content) << name;
  }
}

TEST(OutputFolder, IdentifiesEveryKindByItsManifest) {
  const TemporaryFolder parent;
  const std::vector<std::pair<OutputKind, FileTree>> cases{
      {OutputKind::recording, {{"recording.yaml", "# mine\n\"format\": 'pcavr-recording/1'\n"}}},
      {OutputKind::scene, {{"scene.yaml", "format: pcavr-scene/1\n"}}},
      {OutputKind::run, {{"run.yaml", "format: pcavr-run/1\n"}}},
      {OutputKind::report, {{"report.json", "{\n  \"format\": \"pcavr-report/1\"}"}}},
      {OutputKind::report, {{"report.json", "{\n  \"format\": \"pcavr-identification/1\"}"}}}};
  for (const auto& [kind, content] : cases) {
    const fs::path target = parent.path() / content.begin()->first;
    fs::remove_all(target);
    write_tree(target, content);
    EXPECT_TRUE(OutputFolder::create(target, {.kind = kind, .replace = true}))
        << content.begin()->first;
  }
}

TEST(OutputFolder, ChecksTheOldContentAgainAtTheCommit) {
  const TemporaryFolder parent;
  const fs::path target = parent.path() / "scene";
  write_scene(target, "old");
  Expected<OutputFolder> folder = OutputFolder::create(target, kReplaceScene);
  ASSERT_TRUE(folder);
  write_scene(folder->path(), "new");
  ASSERT_TRUE(write_file(target / "thesis.tex", "years"));
  const Expected<void> committed = folder->commit();
  ASSERT_FALSE(committed);
  EXPECT_NE(committed.error().message.find("thesis.tex"), std::string::npos);
  EXPECT_EQ(*read_file(target / "thesis.tex"), "years");
  EXPECT_EQ(*read_file(parent.path() / "scene.new/mesh.ply"), "new") << "the work is not lost";
  EXPECT_NE(committed.error().hint.find("scene.new"), std::string::npos);
}

TEST(OutputFolder, RefusesATargetThatIsAFile) {
  const TemporaryFolder parent;
  ASSERT_TRUE(write_file(parent.path() / "file", ""));
  EXPECT_FALSE(OutputFolder::create(parent.path() / "file", kReplaceScene));
  EXPECT_FALSE(OutputFolder::create(parent.path() / "file/below"));
}

TEST(OutputFolder, RefusesAnEmptyNameAndALoopOfLinks) {
  const TemporaryFolder parent;
  EXPECT_FALSE(OutputFolder::create(""));
  fs::create_symlink("b", parent.path() / "a");
  fs::create_symlink("a", parent.path() / "b");
  for (const char* name : {"a", "a/scene"}) {
    const Expected<OutputFolder> folder = OutputFolder::create(parent.path() / name);
    ASSERT_FALSE(folder) << name;
    EXPECT_NE(folder.error().message.find("symbolic links"), std::string::npos)
        << folder.error().to_string();
  }
}

TEST(OutputFolder, AcceptsTheLongestNameOfTheFileSystemAndRefusesALongerOne) {
  const TemporaryFolder parent;
  Expected<OutputFolder> folder = OutputFolder::create(parent.path() / std::string(255, 'n'));
  ASSERT_TRUE(folder) << folder.error().to_string();
  EXPECT_TRUE(folder->commit());
  const Expected<OutputFolder> longer = OutputFolder::create(parent.path() / std::string(300, 'n'));
  ASSERT_FALSE(longer);
  EXPECT_NE(longer.error().message.find("too long"), std::string::npos);
  EXPECT_TRUE(write_file(parent.path() / std::string(254, 'f'), "a"));
}

TEST(OutputFolder, WritesThroughASymbolicLink) {
  const TemporaryFolder parent;
  fs::create_directory(parent.path() / "disk");
  fs::create_symlink("disk/scene", parent.path() / "link");
  Expected<OutputFolder> folder = OutputFolder::create(parent.path() / "link");
  ASSERT_TRUE(folder) << folder.error().to_string();
  write_scene(folder->path(), "new");
  ASSERT_TRUE(folder->commit());
  EXPECT_TRUE(fs::is_symlink(parent.path() / "link"));
  EXPECT_EQ(*read_file(parent.path() / "disk/scene/mesh.ply"), "new");
}

TEST(OutputFolder, RefusesUnreadableAndUnwritableFoldersBeforeWriting) {
  const TemporaryFolder parent;
  fs::permissions(parent.path(), fs::perms::all);
  for (const auto& [name, mode] : {std::pair("unreadable", 0300), std::pair("unwritable", 0500)}) {
    write_scene(parent.path() / name, "old");
    fs::permissions(parent.path() / name, static_cast<fs::perms>(mode));
    fs::create_directory(parent.path() / (std::string(name) + "-parent"));
    fs::permissions(parent.path() / (std::string(name) + "-parent"), static_cast<fs::perms>(0500));
  }
  const int code = run_forked([&] {
    if (!drop_privileges()) return kForkedSkip;
    for (const char* name : {"unreadable", "unwritable", "unwritable-parent/scene"}) {
      const auto folder = OutputFolder::create(parent.path() / name, kReplaceScene);
      if (folder || folder.error().message.find("ermission") == std::string::npos) {
        return 1;
      }
    }
    return 0;
  });
  for (const auto& entry : fs::directory_iterator(parent.path())) {
    fs::permissions(entry, fs::perms::owner_all);
  }
  if (code == kForkedSkip) GTEST_SKIP() << "can't become an ordinary user here";
  EXPECT_EQ(code, 0);
}

TEST(OutputFolder, WritesTheCurrentFolderInPlaceSoThatAShellInItStays) {
  const TemporaryFolder parent;
  const fs::path target = parent.path() / "here";
  fs::create_directory(target);
  EXPECT_EQ(run_forked([&] {
              fs::current_path(target);
              Expected<OutputFolder> folder = OutputFolder::create(".");
              if (!folder) return 1;
              if (!write_file(folder->path() / "a.txt", "a") || !folder->commit()) return 2;
              return fs::exists("a.txt") ? 0 : 3;
            }),
            0);
  EXPECT_EQ(tree(parent.path()), (FileTree{{"here/a.txt", "a"}}));
}

TEST(OutputFolder, RemovesWhatADeadProcessLeft) {
  const TemporaryFolder parent;
  const long dead = id_of_dead_process();
  const fs::path left = left_by(parent.path(), "scene", dead);
  const fs::path other = left_by(parent.path(), "scene2", dead);
  EXPECT_TRUE(OutputFolder::create(parent.path() / "scene"));
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(other)) << "another target's";
}

TEST(OutputFolder, TreatsItsOwnProcessIdAsReusedIfItDidNotCreateTheFolder) {
  const TemporaryFolder parent;
  left_by(parent.path(), "scene", ::getpid());
  Expected<OutputFolder> folder = OutputFolder::create(parent.path() / "scene");
  ASSERT_TRUE(folder) << folder.error().to_string();
  EXPECT_TRUE(fs::is_empty(folder->path()));
}

TEST(OutputFolder, KeepsTheFolderOfALiveProcess) {
  const TemporaryFolder parent;
  const fs::path target = parent.path() / "scene";
  ForkedProcess writer([&] {
    Expected<OutputFolder> folder = OutputFolder::create(target);
    ForkedProcess::report_ready();
    ForkedProcess::wait_for_end();
  });
  const fs::path partial = parent.path() / (".scene.partial-" + std::to_string(writer.id()));
  ASSERT_TRUE(fs::exists(partial));
  EXPECT_TRUE(OutputFolder::create(target));
  EXPECT_TRUE(fs::exists(partial));
  writer.kill(SIGKILL);
  EXPECT_TRUE(OutputFolder::create(target));
  EXPECT_FALSE(fs::exists(partial));
}

TEST(OutputFolder, KeepsAFolderThatALiveProcessHasNotLocked) {
  const TemporaryFolder parent;
  ForkedProcess writer([&] {
    ForkedProcess::report_ready();
    ForkedProcess::wait_for_end();
  });
  const fs::path left = left_by(parent.path(), "scene", writer.id());
  EXPECT_TRUE(OutputFolder::create(parent.path() / "scene"));
  EXPECT_TRUE(fs::exists(left));
}

TEST(OutputFolder, KeepsALockedFolderEvenIfItsProcessIsNotVisible) {
  // The process may run in another container, with process ids of its own.
  const TemporaryFolder parent;
  const fs::path left = left_by(parent.path(), "scene", id_of_dead_process());
  const int file = ::open(left.c_str(), O_RDONLY);
  ASSERT_EQ(::flock(file, LOCK_EX), 0);
  EXPECT_TRUE(OutputFolder::create(parent.path() / "scene"));
  EXPECT_TRUE(fs::exists(left));
  ::close(file);
}

TEST(WriteFile, ReplacesAFileAndLeavesNoTemporaryFile) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.txt";
  ASSERT_TRUE(write_file(file, "long content"));
  ASSERT_TRUE(write_file(file, std::string("s\0rt", 4)));
  EXPECT_EQ(tree(folder.path()), (FileTree{{"a.txt", std::string("s\0rt", 4)}}));
}

TEST(WriteFile, NamesTheFileThatCanNotBeWritten) {
  const TemporaryFolder folder;
  const Expected<void> written = write_file(folder.path() / "absent/a.txt", "a");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().file, (folder.path() / "absent/a.txt").string());
}

TEST(WriteFile, ReportsAFileThatCanNotGrow) {
  const TemporaryFolder folder;
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit full{4, before.rlim_max};  // [bytes]; as a full disk, with another errno
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  const Expected<void> written = write_file(folder.path() / "a", "content");
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, ignored);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("large"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

// Such a link in a folder that others may write to would let them choose what is overwritten.
TEST(WriteFile, FollowsNoLinkInPlaceOfItsTemporaryFile) {
  const TemporaryFolder folder, outside;
  ASSERT_TRUE(write_file(outside.path() / "precious", "mine"));
  const fs::path partial = folder.path() / (".a.partial-" + std::to_string(::getpid()));
  fs::create_symlink(outside.path() / "precious", partial);
  ASSERT_TRUE(write_file(folder.path() / "a", "content"));
  EXPECT_EQ(read_file(outside.path() / "precious").value(), "mine");
  EXPECT_EQ(tree(folder.path()), (FileTree{{"a", "content"}}));
}

TEST(ReadFile, RefusesFoldersAndAbsentFiles) {
  const TemporaryFolder folder;
  EXPECT_FALSE(read_file(folder.path()));
  EXPECT_FALSE(read_file(folder.path() / "absent"));
}

TEST(ReadFile, ReadsFilesWithoutASize) {
  if (!fs::exists("/proc/self/status")) GTEST_SKIP() << "needs /proc";
  EXPECT_FALSE(read_file("/proc/self/status")->empty());
}

}  // namespace
}  // namespace pcavr
