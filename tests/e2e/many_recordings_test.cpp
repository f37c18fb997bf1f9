// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// pcavr plan, run, status and gather with the real command: the bytes of single commands, in any
// order and by any number of jobs, and no part of a result where the disk is full.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/json_command.hpp"
#include "support/running_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class ManyRecordings : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    for (const char* seconds : {"6", "7"}) {
      run_json({"simulate", "push", "--no-images", "--seed", "12", "--duration", seconds, "-o",
                path("lab/" + std::string(seconds))});
    }
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }

  /// A plan NAME.json of both recordings; its results are in the folder NAME.
  static std::string plan(const std::string& name, const std::string& chain,
                          std::vector<std::string> recordings = {"lab/6", "lab/7"}) {
    std::vector<std::string> words{"plan", "--chain", chain, "-o", path(name + ".json")};
    for (const std::string& recording : recordings) words.push_back(path(recording));
    run_json(words);
    return path(name + ".json");
  }
  static void expect_refused(const std::vector<std::string>& words, const std::string& why) {
    const CommandOutcome outcome = run_pcavr(words);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_NE(outcome.standard_error.find(why), std::string::npos) << outcome.standard_error;
  }
  static std::string file(const std::string& name) { return read_file(path(name)).value(); }

 private:
  static TemporaryFolder* folder_;
};
TemporaryFolder* ManyRecordings::folder_ = nullptr;

// A run names its scene and parameters: both plans have their results in one place, one after the
// other.
TEST_F(ManyRecordings, GiveTheBytesOfSingleCommandsInAnyOrder) {
  const std::string chain = "build,identify,replay,evaluate";
  const std::string forth = plan("all", chain);
  EXPECT_EQ(run_json({"run", forth, "--jobs", "2"})["ran"], 8);
  EXPECT_EQ(run_json({"status", forth})["done"], 8);
  // Nodes' clocks may be an hour apart: content decides, not times.
  int ahead = 1;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("all"))) {
    if (!entry.is_regular_file()) continue;
    std::filesystem::last_write_time(entry, entry.last_write_time() + std::chrono::hours(ahead));
    ahead = -ahead;
  }
  EXPECT_EQ(run_json({"run", forth})["were_done"], 8);
  run_json({"gather", forth, "--jobs", "2", "-o", path("gathered")});
  std::filesystem::rename(path("all"), path("first"));
  std::filesystem::remove(forth);
  const std::string back = plan("all", chain, {"lab/7", "lab/6"});
  EXPECT_EQ(run_json({"run", back, "--jobs", "1", "--threads", "1"})["ran"], 8);
  run_json({"gather", back, "-o", path("gathered-back")});
  for (const char* name : {"scene", "parameters.report", "run", "report"}) {
    for (const std::string recording : {"/lab/6/", "/lab/7/"})
      EXPECT_EQ(contents(path("first" + recording + name)),
                contents(path("all" + recording + name)))
          << recording << name;
  }
  EXPECT_EQ(contents(path("gathered/parameters")), contents(path("gathered-back/parameters")));
  EXPECT_EQ(file("gathered/friction_atlas.csv"), file("gathered-back/friction_atlas.csv"));

  const std::string scene = path("all/lab/7/scene");
  run_json({"build", path("lab/7"), "-o", path("scene")});
  EXPECT_EQ(contents(path("scene")), contents(scene));
  run_json(
      {"identify", "friction", path("lab/7"), "--scene", scene, "-o", path("parameters.yaml")});
  EXPECT_EQ(file("parameters.yaml"), file("all/lab/7/parameters.yaml"));
  run_json({"replay", path("lab/7"), "--scene", scene, "--parameters",
            path("all/lab/7/parameters.yaml"), "-o", path("run")});
  EXPECT_EQ(contents(path("run")), contents(path("all/lab/7/run")));
}

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    if (*end == '\0') numbers.push_back(number);
  }
  return numbers;
}

// The C library and OpenCV take another way there; the fusion's own kernels are compared to the bit
// by tests/reconstruction.
TEST_F(ManyRecordings, AreTheSameFromANodeWithoutAvx2) {
  const auto cpu = read_file("/proc/cpuinfo");
  if (!cpu || cpu->find(" avx2") == std::string::npos) GTEST_SKIP() << "needs a CPU with AVX2";
  const std::string old_node =
      "export OPENCV_CPU_DISABLE=AVX2,FMA3 "
      "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F,-AVX512VL; ";
  for (const char* name : {"here", "there"}) {
    const std::string file = plan(name, "build,identify,replay", {"lab/6"});
    const CommandOutcome run =
        run_pcavr({"run", file}, name == std::string("there") ? old_node : std::string());
    ASSERT_EQ(run.exit_code, 0) << run.standard_error;
  }
  for (const char* name : {"parameters.yaml", "run/objects/box_1/predicted.txt"}) {
    const std::vector<double> here = numbers_of(file("here/lab/6/" + std::string(name)));
    const std::vector<double> there = numbers_of(file("there/lab/6/" + std::string(name)));
    ASSERT_EQ(here.size(), there.size()) << name;
    ASSERT_GT(here.size(), 10U) << name;
    // exp and pow of the C library differ in their last digits, which a fit may grow.
    for (std::size_t i = 0; i < here.size(); ++i)
      EXPECT_NEAR(there[i], here[i], 1e-9 * std::max(1.0, std::abs(here[i]))) << name << ' ' << i;
  }
}

TEST_F(ManyRecordings, AreSharedByTwoRunsAtOnce) {
  const std::string shared = plan("shared", "build,identify");
  RunningCommand other({"run", shared, "--jobs", "2", "--json"}, path("."), "other");
  const auto own = run_json({"run", shared, "--jobs", "2"});
  EXPECT_EQ(other.wait(), 0);
  const auto others = nlohmann::json::parse(other.output());
  EXPECT_EQ(own["ran"].get<int>() + others["ran"].get<int>(), 4);
  EXPECT_EQ(run_json({"status", shared})["done"], 4);
}

// The limit takes the place of a full disk: no file may be larger than 8 or 16 kB.
TEST_F(ManyRecordings, LeaveNoPartWhereTheDiskIsFullAndAreFinishedAfterwards) {
  const std::string full = plan("full", "build");
  const CommandOutcome outcome = run_pcavr({"run", full}, "ulimit -f 16; ");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_output;
  EXPECT_EQ(run_json({"status", full})["failed"], 2);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("full"))) {
    EXPECT_NE(entry.path().filename(), "scene");
    EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
  }
  EXPECT_EQ(run_json({"run", full, "--jobs", "2"})["ran"], 2);
}

TEST_F(ManyRecordings, AreRefusedInOneLine) {
  expect_refused({"plan", path("lab/6"), path("lab/6"), "-o", path("twice.json")},
                 "is the same recording as");
  expect_refused({"plan", path("none"), "-o", path("none.json")}, "none");
  std::ofstream(path("list.txt")) << "lab/6\nlab/lost\n";
  expect_refused({"plan", path("list.txt"), "-o", path("none.json")},
                 "line 2: is not a folder: lab/lost");
  EXPECT_FALSE(std::filesystem::exists(path("none.json")));

  const std::string changed = path("changed");
  std::filesystem::copy(path("lab/6"), changed, std::filesystem::copy_options::recursive);
  for (const auto& entry : std::filesystem::directory_iterator(changed + "/objects"))
    std::ofstream(entry.path(), std::ios::app) << "# another body\n";
  expect_refused({"plan", changed, path("lab/7"), "-o", path("none.json")},
                 "has another CAD file than in");
  const std::string newer = path("newer");
  std::filesystem::copy(path("lab/6"), newer, std::filesystem::copy_options::recursive);
  std::string manifest = file("newer/recording.yaml");
  const std::string version = "pcavr-recording/1";
  ASSERT_NE(manifest.find(version), std::string::npos);
  manifest.replace(manifest.find(version), version.size(), "pcavr-recording/9");
  std::ofstream(newer + "/recording.yaml") << manifest;
  expect_refused({"plan", newer, path("lab/7"), "-o", path("none.json")}, "pcavr-recording/9");
  EXPECT_FALSE(std::filesystem::exists(path("none.json")));
  const std::string of_changed = plan("of_changed", "build", {"changed"});
  std::ofstream(changed + "/tool.csv", std::ios::app) << "\n";
  for (const char* command : {"run", "status"})
    expect_refused({command, of_changed}, "has changed since the plan was made");
  std::filesystem::remove_all(changed);
  for (const char* command : {"run", "status"})
    expect_refused({command, of_changed}, "changed: can't be read");
  EXPECT_FALSE(std::filesystem::exists(path("of_changed")));
}

}  // namespace
}  // namespace pcavr
