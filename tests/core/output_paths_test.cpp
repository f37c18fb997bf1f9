// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/output_paths.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include "support/file_tree.hpp"
#include "support/forked.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

class CheckOutputs : public testing::Test {
 protected:
  void SetUp() override {
    write_tree(root(), {{"home/recording/rgb/1.png", "1"}, {"home/p.yaml", "p"}});
    fs::create_symlink("home/recording", root() / "link");
    fs::create_symlink("../../..", root() / "home/recording/up");
  }

  [[nodiscard]] fs::path root() const { return folder_.path(); }
  [[nodiscard]] bool is_accepted(const fs::path& output) const {
    return check_outputs({output}, {root() / "home/recording", root() / "home/p.yaml", ""})
        .has_value();
  }

  TemporaryFolder folder_;
};

TEST_F(CheckOutputs, AllowsOutputsThatDoNotOverlapTheInputs) {
  EXPECT_TRUE(is_accepted(root() / "scene"));
  EXPECT_TRUE(is_accepted(root() / "home/scene"));
  EXPECT_TRUE(is_accepted(root() / "home/recording2"));
  EXPECT_TRUE(is_accepted(root() / "home/recording/../scene"));
}

TEST_F(CheckOutputs, RefusesAnInputWhateverItsName) {
  EXPECT_FALSE(is_accepted(root() / "home/recording"));
  EXPECT_FALSE(is_accepted(root() / "home/recording/"));
  EXPECT_FALSE(is_accepted(root() / "home/./x/../recording"));
  EXPECT_FALSE(is_accepted(root() / "link"));
  EXPECT_FALSE(is_accepted(root() / "home/p.yaml"));
}

TEST_F(CheckOutputs, RefusesAnOutputThatContainsAnInput) {
  EXPECT_FALSE(is_accepted(root() / "home"));
  EXPECT_FALSE(is_accepted(root()));
  EXPECT_FALSE(is_accepted("/"));
  EXPECT_FALSE(is_accepted(root() / "link/.."));
}

TEST_F(CheckOutputs, RefusesAnOutputInsideAnInputExistingOrNot) {
  EXPECT_FALSE(is_accepted(root() / "home/recording/rgb"));
  EXPECT_FALSE(is_accepted(root() / "home/recording/new/scene"));
  EXPECT_FALSE(is_accepted(root() / "link/new"));
  EXPECT_TRUE(is_accepted(root() / "home/recording/up/apart")) << "a link that leads out";
}

TEST_F(CheckOutputs, FollowsALinkToAPathThatDoesNotExistYet) {
  fs::create_symlink("home/recording/new", root() / "dangling");
  EXPECT_FALSE(is_accepted(root() / "dangling"));
}

TEST_F(CheckOutputs, NamesBothPathsAndHowTheyOverlap) {
  const Expected<void> checked = check_outputs({root() / "home"}, {root() / "link"});
  ASSERT_FALSE(checked);
  const std::string line = checked.error().to_string();
  EXPECT_NE(line.find((root() / "home").string() + ": contains the input"), line.npos) << line;
  EXPECT_NE(line.find((root() / "link").string()), line.npos) << line;
}

TEST_F(CheckOutputs, RefusesOutputsThatOverlap) {
  EXPECT_FALSE(check_outputs({root() / "out", root() / "out/report"}, {}));
  EXPECT_FALSE(check_outputs({root() / "out/p.yaml", root() / "out"}, {}));
  EXPECT_FALSE(check_outputs({root() / "out", root() / "x/../out"}, {}));
  EXPECT_TRUE(check_outputs({root() / "p.yaml", root() / "p.report"}, {}));
}

TEST_F(CheckOutputs, RefusesAnEmptyOutputAndIgnoresAMissingInput) {
  EXPECT_FALSE(check_outputs({""}, {}));
  EXPECT_TRUE(check_outputs({root() / "out"}, {root() / "absent", "/proc/nowhere/x"}));
}

TEST_F(CheckOutputs, DetectsAnOverlapThroughABindMount) {
  fs::create_directory(root() / "mounted");
  const int code = run_forked([&] {
    if (::unshare(CLONE_NEWNS) != 0 ||
        ::mount((root() / "home").c_str(), (root() / "mounted").c_str(), nullptr, MS_BIND,
                nullptr) != 0) {
      return kForkedSkip;
    }
    return is_accepted(root() / "mounted/recording") || is_accepted(root() / "mounted") ? 1 : 0;
  });
  if (code == kForkedSkip) GTEST_SKIP() << "may not mount here";
  EXPECT_EQ(code, 0);
}

}  // namespace
}  // namespace pcavr
