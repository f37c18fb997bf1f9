// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/signal_cleanup.hpp"

#include <thread>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_file.hpp"

#include "support/file_tree.hpp"
#include "support/forked.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

/// Writes files until the process ends, like a command that is computing.
[[noreturn]] void write_forever(const fs::path& folder) {
  for (int i = 0;; ++i) {
    std::error_code ignored;
    fs::create_directories(folder / "rgb", ignored);
    if (write_file(folder / "rgb" / (std::to_string(i % 50) + ".png"), "image")) continue;
  }
}

TEST(SignalCleanup, RemovesUncommittedOutputAndExitsWithTheShellsCode) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const TemporaryFolder parent;
    ForkedProcess command([&] {
      install_signal_cleanup();
      Expected<OutputFolder> folder = OutputFolder::create(parent.path() / "new/scene");
      Expected<OutputFile> file = OutputFile::create(parent.path() / "p.yaml", {});
      std::thread([&] { write_forever(folder->path()); }).detach();
      ForkedProcess::report_ready();
      write_forever(folder->path());
    });
    const int status = command.kill(signal);
    ASSERT_TRUE(WIFEXITED(status)) << signal;
    EXPECT_EQ(WEXITSTATUS(status), 128 + signal);
    EXPECT_TRUE(fs::is_empty(parent.path())) << testing::PrintToString(tree(parent.path()));
  }
}

TEST(SignalCleanup, KeepsCommittedOutput) {
  const TemporaryFolder parent;
  ForkedProcess command([&] {
    install_signal_cleanup();
    Expected<OutputFolder> folder = OutputFolder::create(parent.path() / "scene");
    if (!write_file(folder->path() / "a", "a") || !folder->commit()) ::_exit(1);
    ForkedProcess::report_ready();
    ForkedProcess::wait_for_end();
  });
  EXPECT_EQ(WEXITSTATUS(command.kill(SIGTERM)), 128 + SIGTERM);
  EXPECT_EQ(tree(parent.path()), (FileTree{{"scene/a", "a"}}));
}

TEST(SignalCleanup, SuppressesErrorsDuringTheCleanup) {
  ForkedProcess command([&] {
    install_signal_cleanup();
    ::raise(SIGINT);
    wait_if_interrupted();
    ::_exit(1);
  });
  EXPECT_EQ(WEXITSTATUS(command.wait()), 128 + SIGINT);
}

TEST(SignalCleanup, LeavesIgnoredSignalsIgnored) {
  ForkedProcess command([&] {
    ::signal(SIGHUP, SIG_IGN);
    install_signal_cleanup();
    ::raise(SIGHUP);
    ::_exit(7);
  });
  EXPECT_EQ(WEXITSTATUS(command.wait()), 7);
}

TEST(SignalCleanup, MakesAFileSizeLimitAnError) {
  ForkedProcess command([&] {
    install_signal_cleanup();
    ::raise(SIGXFSZ);
    ::_exit(7);
  });
  EXPECT_EQ(WEXITSTATUS(command.wait()), 7);
}

}  // namespace
}  // namespace pcavr
