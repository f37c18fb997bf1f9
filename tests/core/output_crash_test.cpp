// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A process killed at any instant leaves the old or the new output, complete, and the next one
// removes its temporary files.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <random>

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include "pcavr/base/core/output.hpp"

#include "base/core/commit_hooks.hpp"
#include "support/file_tree.hpp"
#include "support/forked.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

constexpr OutputFolderOptions kReplaceOldScene{.kind = OutputKind::scene, .replace = true};

FileTree scene(const std::string& generation) {
  return {{"scene.yaml", "format: pcavr-scene/1\nname: " + generation + "\n"},
          {"mesh.ply", generation},
          {"lod/static_mesh_1.glb", generation},
          {generation == "old" ? "cloud.ply" : "preview.png", generation}};
}

enum class Path { exchange, renames, inside };

/// Replaces the old scene, or writes the first one; runs in the process that is killed.
void write_new(const fs::path& target, Path path, CommitHooks hooks) {
  if (path == Path::inside) fs::current_path(target);
  hooks.can_exchange = path != Path::renames;
  Expected<OutputFolder> folder = OutputFolder::create(target, kReplaceOldScene);
  if (!folder) ::_exit(2);
  write_tree(folder->path(), scene("new"));
  if (!folder->commit(hooks)) ::_exit(3);
}

/// Expects the old or the new content, and nothing else, after a run that does not replace
/// anything.
void expect_intact(const fs::path& parent, const FileTree& old) {
  const fs::path target = parent / "scene";
  const bool is_created = OutputFolder::create(target).has_value();
  const FileTree found = tree(target);
  EXPECT_EQ(is_created, found.empty());
  EXPECT_TRUE(found == old || found == scene("new")) << testing::PrintToString(found);
  EXPECT_EQ(tree(parent).size(), found.size()) << testing::PrintToString(tree(parent));
}

/// Kills by a kernel timer, so that the instant does not depend on when the parent is scheduled.
void kill_self_after(long microseconds) {
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGKILL;
  timer_t timer{};
  itimerspec instant{};
  instant.it_value.tv_nsec = 1000 * microseconds + 1;
  if (::timer_create(CLOCK_MONOTONIC, &event, &timer) != 0) ::_exit(4);
  ::timer_settime(timer, 0, &instant, nullptr);
}

/// [us] Duration of a commit that is not killed: the minimum of three, because of other load.
long usual_duration(const fs::path& target, Path path) {
  long shortest = 1'000'000;
  for (int i = 0; i < 3; ++i) {
    const auto start = std::chrono::steady_clock::now();
    ForkedProcess([&] { write_new(target, path, {}); }).wait();
    const auto duration = std::chrono::steady_clock::now() - start;
    shortest = std::min<long>(
        shortest, std::chrono::duration_cast<std::chrono::microseconds>(duration).count());
  }
  return shortest;
}

class Crash : public testing::TestWithParam<Path> {};

TEST_P(Crash, AtEachStepLeavesTheOldOrTheNew) {
  for (const bool has_old : {true, false}) {
    bool is_killed = true;
    for (int kill_at = 0; is_killed; ++kill_at) {
      const TemporaryFolder parent;
      const fs::path target = parent.path() / "scene";
      fs::create_directory(target);
      const FileTree old = has_old ? scene("old") : FileTree{};
      write_tree(target, old);
      ForkedProcess child([&] {
        int count = 0;
        const auto before = [&](const char*) {
          if (count++ == kill_at) ::raise(SIGKILL);
        };
        write_new(target, GetParam(), {.before_step = before});
      });
      const int status = child.wait();
      is_killed = WIFSIGNALED(status);
      ASSERT_TRUE(is_killed || WEXITSTATUS(status) == 0) << WEXITSTATUS(status);
      SCOPED_TRACE("killed at step " + std::to_string(kill_at));
      if (GetParam() == Path::exchange) {
        const FileTree found = tree(target);
        EXPECT_TRUE(found == old || found == scene("new")) << "at once, before any other run";
      }
      if (GetParam() == Path::inside && fs::exists(target / "scene.yaml")) {
        // A reader sees all of the content where there is a manifest.
        FileTree shown = tree(target);
        std::erase_if(shown, [](const auto& file) { return file.first.front() == '.'; });
        EXPECT_TRUE(shown == old || shown == scene("new")) << testing::PrintToString(shown);
      }
      expect_intact(parent.path(), old);
      if (!is_killed) {
        EXPECT_GE(kill_at, has_old ? 4 : 3) << "as many steps were tried";
        EXPECT_EQ(tree(target), scene("new"));
      }
    }
  }
}

TEST_P(Crash, AtARandomInstantLeavesTheOldOrTheNew) {
  constexpr int kKills = 200;
  // The folder is in memory where possible: nothing waits for the disk, and most kills fall between
  // two system calls of the writer.
  if (fs::exists("/dev/shm")) ::setenv("TMPDIR", "/dev/shm", 1);
  const TemporaryFolder parent;
  ::unsetenv("TMPDIR");
  const fs::path target = parent.path() / "scene";
  write_tree(target, scene("old"));
  const long longest = usual_duration(target, GetParam());
  std::mt19937 random(20);
  std::uniform_int_distribution<long> delay(0, longest);
  int kept_old = 0;
  for (int i = 0; i < kKills && !HasFailure(); ++i) {
    fs::remove_all(target);
    write_tree(target, scene("old"));
    const long instant = delay(random);
    ForkedProcess([&] {
      kill_self_after(instant);
      write_new(target, GetParam(), {});
    }).wait();
    expect_intact(parent.path(), scene("old"));
    kept_old += tree(target) == scene("old") ? 1 : 0;
  }
  RecordProperty("kept_old", kept_old);
}

INSTANTIATE_TEST_SUITE_P(OfACommit, Crash,
                         testing::Values(Path::exchange, Path::renames, Path::inside),
                         [](const auto& test) -> std::string {
                           if (test.param == Path::exchange) return "ThatExchanges";
                           return test.param == Path::renames ? "ThatRenames" : "Inside";
                         });

/// Runs in a child with a mount of its own at `folder`; kForkedSkip where that is not allowed.
template <typename Function>
int run_mounted(const fs::path& folder, const char* source, const Function& function) {
  return run_forked([&] {
    if (::unshare(CLONE_NEWNS) != 0) return kForkedSkip;
    ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
    const bool is_bind = source != nullptr;
    const int done = ::mount(is_bind ? source : "tmpfs", folder.c_str(),
                             is_bind ? nullptr : "tmpfs", is_bind ? MS_BIND : 0, nullptr);
    return done == 0 ? function() : kForkedSkip;
  });
}

/// A container's file system: its image lies in a read-only layer. Neither an exchange nor a rename
/// of its folders is possible there.
TEST(OverlayFileSystem, ReplacesAnOutputOfItsLowerLayerAndKeepsItIntactInACrash) {
  const TemporaryFolder parent;
  bool is_killed = true;
  for (int kill_at = 0; is_killed; ++kill_at) {
    const std::string root = (parent.path() / std::to_string(kill_at)).string();
    for (const char* name : {"upper", "work", "merged"}) {
      fs::create_directories(fs::path(root) / name);
    }
    write_tree(root + "/lower/scene", scene("old"));
    const std::string layers =
        "lowerdir=" + root + "/lower,upperdir=" + root + "/upper,workdir=" + root + "/work";
    const int code = run_forked([&] {
      if (::unshare(CLONE_NEWNS) != 0) return kForkedSkip;
      ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
      const fs::path merged = root + "/merged";
      if (::mount("overlay", merged.c_str(), "overlay", 0, layers.c_str()) != 0) {
        return kForkedSkip;
      }
      int count = 0;
      const CommitHooks hooks{.before_step = [&](const char*) {
        if (count++ == kill_at) ::raise(SIGKILL);
      }};
      const int status =
          ForkedProcess([&] { write_new(merged / "scene", Path::exchange, hooks); }).wait();
      expect_intact(merged, scene("old"));
      const bool has_ended = WIFEXITED(status);
      if (has_ended && (WEXITSTATUS(status) != 0 || tree(merged / "scene") != scene("new"))) {
        return 2;
      }
      return testing::Test::HasFailure() ? 2 : (has_ended ? 1 : 0);
    });
    if (code == kForkedSkip) GTEST_SKIP() << "may not mount here";
    ASSERT_TRUE(code == 0 || code == 1) << "killed at step " << kill_at;
    is_killed = code == 0;
    EXPECT_TRUE(is_killed || kill_at >= 10) << "as many steps were tried";
  }
}

class MountPoint : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    fs::create_directory(parent_.path() / "source");
    fs::create_directory(target());
  }
  [[nodiscard]] fs::path target() const { return parent_.path() / "out"; }

  template <typename Function>
  void run(const Function& function) const {
    const std::string source = (parent_.path() / "source").string();
    const int code = run_mounted(target(), GetParam() ? source.c_str() : nullptr, function);
    if (code == kForkedSkip) GTEST_SKIP() << "may not mount here";
    EXPECT_EQ(code, 0);
  }

  TemporaryFolder parent_;
};

TEST_P(MountPoint, IsWrittenInPlace) {
  run([&] {
    fs::create_directory(target() / "lost+found");
    Expected<OutputFolder> folder = OutputFolder::create(target());
    if (!folder) return 1;
    write_tree(folder->path(), scene("old"));
    if (tree(target()).contains("scene.yaml")) return 2;
    if (!folder->commit()) return 3;
    return tree(target()) == scene("old") && fs::exists(target() / "lost+found") ? 0 : 4;
  });
}

TEST_P(MountPoint, IsReplacedInPlace) {
  run([&] {
    write_tree(target(), scene("old"));
    if (OutputFolder::create(target())) return 1;
    Expected<OutputFolder> folder = OutputFolder::create(target(), kReplaceOldScene);
    if (!folder) return 2;
    write_tree(folder->path(), scene("new"));
    if (tree(target()).at("scene.yaml") != scene("old").at("scene.yaml")) return 3;
    if (!folder->commit()) return 4;
    return tree(target()) == scene("new") ? 0 : 5;
  });
}

TEST_P(MountPoint, KeepsFilesThatAreNotAnOutput) {
  run([&] {
    const FileTree precious{{"thesis.tex", "years"}};
    write_tree(target(), precious);
    if (OutputFolder::create(target(), kReplaceOldScene)) return 1;
    return tree(target()) == precious ? 0 : 2;
  });
}

TEST_P(MountPoint, IsLeftAsItWasWithoutACommit) {
  run([&] {
    {
      const Expected<OutputFolder> folder = OutputFolder::create(target());
      if (!folder) return 1;
      write_tree(folder->path(), scene("new"));
    }
    return fs::is_empty(target()) ? 0 : 2;
  });
}

INSTANTIATE_TEST_SUITE_P(Of, MountPoint, testing::Values(false, true), [](const auto& test) {
  return test.param ? std::string("ABoundFolder") : std::string("AFileSystem");
});

}  // namespace
}  // namespace pcavr
