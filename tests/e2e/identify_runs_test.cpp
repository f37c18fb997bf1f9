// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Several recordings of the same boxes, with the real command.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/json_command.hpp"
#include "support/shared_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class IdentifyRunsCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    simulate("lab/a", {"--seed", "12"});
    simulate("lab/b", {"--seed", "12", "--duration", "20"});
    simulate("other", {"--seed", "13"});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path_of(const std::string& name) { return (folder_->path() / name).string(); }
  static void simulate(const std::string& name, std::vector<std::string> more) {
    std::filesystem::create_directories((folder_->path() / name).parent_path());
    std::vector<std::string> words{"simulate", "push", "--no-images", "-o", path_of(name)};
    words.insert(words.end(), more.begin(), more.end());
    run_json(words);
  }
  /// The parameter file that the recordings give.
  static std::string identified(const std::vector<std::string>& recordings,
                                const std::string& name) {
    std::vector<std::string> words{"identify", "friction", "-o", path_of(name + ".yaml")};
    words.insert(words.end(), recordings.begin(), recordings.end());
    run_json(words);
    return read_file(path_of(name + ".yaml")).value();
  }
  static void expect_refused(const std::vector<std::string>& recordings, const std::string& why) {
    std::vector<std::string> words{"identify", "friction", "-o", path_of("refused.yaml")};
    words.insert(words.end(), recordings.begin(), recordings.end());
    const CommandOutcome outcome = run_pcavr(words);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.standard_error.find(why), std::string::npos) << outcome.standard_error;
    EXPECT_FALSE(std::filesystem::exists(path_of("refused.yaml")));
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* IdentifyRunsCommand::folder_ = nullptr;

TEST_F(IdentifyRunsCommand, GiveOneAnswerInAnyOrderByAListAndByTheirFolder) {
  const std::string found = identified({path_of("lab/a"), path_of("lab/b")}, "ab");
  EXPECT_EQ(identified({path_of("lab/b"), path_of("lab/a")}, "ba"), found);
  EXPECT_EQ(identified({path_of("lab")}, "folder"), found);
  std::ofstream(path_of("list.txt")) << "# runs of a day\nlab/b\n\nlab/a\n";
  EXPECT_EQ(identified({path_of("list.txt")}, "list"), found);
  for (const char* file : {"report.json", "runs.csv", "parameters.tex"})
    EXPECT_TRUE(std::filesystem::exists(path_of(std::string("ab.report/") + file))) << file;
}

TEST_F(IdentifyRunsCommand, CombineWithWhatOtherRunsShowedAndWithNoRunTwice) {
  const auto std_of = [](const std::string& text) {
    const std::string key = "limiting_static_friction_std: ";
    return std::stod(text.substr(text.find(key) + key.size()));
  };
  const std::string before = identified({path_of("lab/b")}, "b");
  const std::string alone = identified({path_of("lab/a")}, "a");
  const std::string both =
      identified({path_of("lab/a"), "--parameters", path_of("b.yaml")}, "both");
  EXPECT_LT(std_of(both), std_of(before));
  EXPECT_LT(std_of(both), std_of(alone));
  const std::string again =
      identified({path_of("lab/a"), "--parameters", path_of("both.yaml")}, "again");
  EXPECT_NEAR(std_of(again) / std_of(alone), 1.0, 0.1);
}

TEST_F(IdentifyRunsCommand, AreIdentifiedByGroupToo) {
  identified({path_of("lab/a"), path_of("lab/b"), "--group-by", "support"}, "support");
  const auto report =
      nlohmann::json::parse(read_file(path_of("support.report/report.json")).value());
  const auto& object = report["objects"][0];
  ASSERT_EQ(object["groups"].size(), 1U);
  EXPECT_EQ(object["groups"][0]["name"], "lab");
  EXPECT_EQ(object["groups"][0]["runs"], object["runs"]);
  for (const auto& [name, parameter] : object["groups"][0]["parameters"].items())
    EXPECT_EQ(parameter["value"], object["parameters"][name]["value"]) << name;
  EXPECT_TRUE(std::filesystem::exists(path_of("support.report/groups.csv")));
}

TEST_F(IdentifyRunsCommand, HaveAGroupForEachSupport) {
  std::filesystem::create_directories(path_of("floor"));
  std::filesystem::copy(path_of("lab/b"), path_of("floor/b"),
                        std::filesystem::copy_options::recursive);
  identified({path_of("lab/a"), path_of("floor/b"), "--group-by", "support"}, "two");
  const auto report = nlohmann::json::parse(read_file(path_of("two.report/report.json")).value());
  const auto& groups = report["objects"][0]["groups"];
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0]["name"], "floor");
  EXPECT_EQ(groups[1]["name"], "lab");
  EXPECT_EQ(groups[0]["runs"].size(), 1U);
  EXPECT_EQ(groups[1]["runs"].size(), 1U);
  EXPECT_NE(groups[0]["runs"], groups[1]["runs"]);
}

TEST_F(IdentifyRunsCommand, MayHaveASceneEach) {
  for (const std::string name : {"a", "b"})
    run_json({"build", path_of("lab/" + name), "-o", path_of("scene-" + name)});
  const std::string found = identified({path_of("lab/b"), path_of("lab/a"), "--scene",
                                        path_of("scene-b"), "--scene", path_of("scene-a")},
                                       "scenes");
  EXPECT_EQ(identified({path_of("lab/a"), path_of("lab/b"), "--scene", path_of("scene-a"),
                        "--scene", path_of("scene-b")},
                       "scenes-again"),
            found);
  expect_refused({path_of("lab"), path_of("other"), "--scene", path_of("scene-a"), "--scene",
                  path_of("scene-b")},
                 "--scene: is given 2 times for 3 recordings");
}

TEST_F(IdentifyRunsCommand, RefuseWhatIsNotOneKind) {
  expect_refused({path_of("lab/a"), path_of("other")}, "box_1 has another CAD body than in");
  expect_refused({path_of("lab/a"), path_of("lab/a")}, "is the same recording as");
  expect_refused({path_of("lab"), "--plan", path_of("plan.csv")}, "is for one recording");
  std::ofstream(path_of("lost.txt")) << "lab/a\nlab/lost\n";
  expect_refused({path_of("lost.txt")}, "line 2: is not a folder: lab/lost");
}

// Real pushes of a block on hardboard, one in each recording: halves of them give the same
// friction.
TEST_F(IdentifyRunsCommand, AgreeBetweenHalvesOfRealPushes) {
  PCAVR_NEEDS_SHARED_DATA("real/push_cmu/recordings/patch");
  const std::filesystem::path data = shared_data("real/push_cmu/recordings/patch");
  std::vector<std::string> halves[2];
  for (const auto& entry : std::filesystem::directory_iterator(data)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("test")) halves[(name.back() - '0') % 2].push_back(entry.path().string());
  }
  double value[2] = {}, std[2] = {};
  for (int half = 0; half < 2; ++half) {
    ASSERT_GT(halves[half].size(), 3U);
    const std::string text = identified(halves[half], "half" + std::to_string(half));
    const auto number = [&](const std::string& key) {
      return std::stod(text.substr(text.find(key + ": ") + key.size() + 2));
    };
    value[half] = number("sliding_friction_coefficient");
    std[half] = number("sliding_friction_coefficient_std");
  }
  EXPECT_LT(std::abs(value[0] - value[1]), 2.5 * std::hypot(std[0], std[1]));
}

}  // namespace
}  // namespace pcavr
