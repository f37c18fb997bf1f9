// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// pcavr plan, run, status and gather with the real command: the bytes of single commands, in any
// order and by any number of jobs, and no part of a result where the disk is full.
#include <filesystem>
#include <fstream>
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

TEST_F(ManyRecordings, GiveTheBytesOfSingleCommandsInAnyOrder) {
  const std::string chain = "build,identify,replay,evaluate";
  const std::string forth = plan("forth", chain);
  const std::string back = plan("back", chain, {"lab/7", "lab/6"});
  EXPECT_EQ(run_json({"run", forth, "--jobs", "2"})["ran"], 8);
  EXPECT_EQ(run_json({"run", back, "--jobs", "1", "--threads", "1"})["ran"], 8);
  EXPECT_EQ(run_json({"status", forth})["done"], 8);
  EXPECT_EQ(run_json({"run", forth})["were_done"], 8);

  run_json({"build", path("lab/7"), "-o", path("scene")});
  run_json({"identify", "friction", path("lab/7"), "--scene", path("scene"), "-o",
            path("parameters.yaml")});
  run_json({"replay", path("lab/7"), "--scene", path("scene"), "--parameters",
            path("parameters.yaml"), "-o", path("run")});
  run_json({"evaluate", path("run"), "--truth", path("lab/7/truth"), "-o", path("report")});
  for (const char* name : {"scene", "parameters.report", "run", "report"}) {
    const auto planned = contents(path("forth/lab/7/" + std::string(name)));
    EXPECT_EQ(contents(path(name)), planned) << name;
    EXPECT_EQ(contents(path("back/lab/7/" + std::string(name))), planned) << name;
  }
  EXPECT_EQ(file("parameters.yaml"), file("forth/lab/7/parameters.yaml"));

  run_json({"gather", forth, "--jobs", "2", "-o", path("gathered-forth")});
  run_json({"gather", back, "-o", path("gathered-back")});
  EXPECT_EQ(contents(path("gathered-forth")), contents(path("gathered-back")));
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
  const std::string of_changed = plan("of_changed", "build", {"changed"});
  std::ofstream(changed + "/tool.csv", std::ios::app) << "\n";
  for (const char* command : {"run", "status"})
    expect_refused({command, of_changed}, "has changed since the plan was made");
  EXPECT_FALSE(std::filesystem::exists(path("of_changed")));
}

}  // namespace
}  // namespace pcavr
