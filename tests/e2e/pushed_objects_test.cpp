// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Pushes by the real command: identify, replay over a delayed link, evaluate; and what each of them
// says to bad input. The seeds were drawn for this file; nothing was tuned on them.
#include <cmath>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "support/json_command.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// One line on standard error that holds the words, and exit code 1.
void expect_refused(const CommandOutcome& outcome, const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
  EXPECT_EQ(outcome.standard_output, "");
  for (const std::string& word : words) {
    EXPECT_NE(outcome.standard_error.find(word), std::string::npos)
        << "no '" << word << "' in: " << outcome.standard_error;
  }
}

void edit(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = read_file(file).value();
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from << " is not in " << file;
  ASSERT_TRUE(write_file(file, text.replace(at, from.size(), to)));
}

/// One seed's boxes: probed, identified, and pushed in another recording.
class PushedObjects : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    simulate("probe", "probe", {});
    run_json({"identify", "friction", place("probe"), "--scene", place("probe-scene"), "--tracked",
              place("probe/tracked"), "-o", place("parameters.yaml")});
    simulate("push", "push", {});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static std::string place(const std::string& name) { return (folder_->path() / name).string(); }

  /// A recording without images in `name`, and its scene in `name`-scene.
  static void simulate(const std::string& task, const std::string& name,
                       const std::vector<std::string>& faults) {
    std::vector<std::string> words = {"simulate",    task,     "-o",  place(name),
                                      "--no-images", "--seed", "8101"};
    words.insert(words.end(), faults.begin(), faults.end());
    run_json(words);
    run_json({"build", place(name), "-o", place(name + "-scene")});
  }

  static std::vector<std::string> replay_words(const std::string& recording,
                                               const std::string& run) {
    return {"replay",    place(recording),
            "--scene",   place(recording + "-scene"),
            "--tracked", place(recording + "/tracked"),
            "-o",        place(run)};
  }

  static json replay_and_evaluate(const std::string& recording, const std::string& run,
                                  const std::vector<std::string>& more) {
    std::vector<std::string> words = replay_words(recording, run);
    words.insert(words.end(), more.begin(), more.end());
    run_json(words);
    return run_json({"evaluate", place(run), "--truth", place(recording + "/truth"), "-o",
                     place(run + "-report")});
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* PushedObjects::folder_ = nullptr;

TEST_F(PushedObjects, AreIdentified) {
  const json report = run_json({"evaluate", place("parameters.yaml"), "--truth",
                                place("probe/truth"), "-o", place("parameters-report")});
  for (const std::string box : {"box_1", "box_2"}) {
    const std::string key = "parameters." + box + ".";
    for (const auto& [name, bound] :
         std::map<std::string, double>{{"limiting_static_friction", 0.02},
                                       {"sliding_friction_coefficient", 0.03},
                                       {"mass", 0.05}}) {
      expect_within(report, key + name + ".error_relative", bound);
    }
  }
}

TEST_F(PushedObjects, ArePredictedAloneWhileTheySlide) {
  const json report = replay_and_evaluate(
      "push", "alone",
      {"--parameters", place("parameters.yaml"), "--no-corrections", "--keep-parameters"});
  expect_within(report, "predicted.phase.sliding.translation.rmse_m", 0.001);
  expect_within(report, "predicted.phase.sliding.translation.max_m", 0.004);
}

TEST_F(PushedObjects, AreShownWhereTheyAreAcrossADelayedLink) {
  const json report =
      replay_and_evaluate("push", "delayed", {"--parameters", place("parameters.yaml")});
  expect_within(report, "predicted.touched.translation.median_m", 0.0015);
  expect_within(report, "predicted.touched.translation.p95_m", 0.004);
  expect_within(report, "phases.measured.boundary.median_s", 0.060);
  expect_within(report, "phases.predicted.boundary.median_s", 0.060);
  expect_within(report, "corrections.share_of_streaming", 0.03);
}

TEST_F(PushedObjects, AreLearntOnTheWayWhereNothingIsKnown) {
  const json report = replay_and_evaluate("push", "unknown", {});
  expect_within(report, "predicted.touched.translation.median_m", 0.0015);
  expect_within(report, "corrections.share_of_streaming", 0.03);
}

TEST_F(PushedObjects, AreReplayedToTheSameBytes) {
  std::vector<std::string> once = replay_words("push", "same");
  run_json(once);
  const auto before = contents(place("same"));
  once.emplace_back("--force");
  run_json(once);
  EXPECT_EQ(contents(place("same")), before);
}

TEST_F(PushedObjects, MayBeLostByTheCameraInMidPush) {
  simulate("push", "lost", {"--lose-tracking", "2:4"});
  const json report =
      replay_and_evaluate("lost", "lost-run", {"--parameters", place("parameters.yaml")});
  expect_within(report, "predicted.touched.translation.p95_m", 0.004);
  EXPECT_NE(read_file(fs::path(place("lost-run")) / "run.yaml")->find("lost"), std::string::npos);
}

TEST_F(PushedObjects, AreStillTrackedWhereTheWrenchIsMissing) {
  simulate("push", "no-wrench", {});
  fs::remove(fs::path(place("no-wrench")) / "wrench.csv");
  run_json(replay_words("no-wrench", "no-wrench-run"));
  EXPECT_GT(fs::file_size(fs::path(place("no-wrench-run")) / "objects/box_1/tracked.txt"), 1000U);
  expect_refused(run_pcavr({"identify", "friction", place("no-wrench"), "--scene",
                            place("no-wrench-scene"), "-o", place("no-wrench.yaml")}),
                 {"wrench.csv"});
  EXPECT_FALSE(fs::exists(place("no-wrench.yaml")));
}

TEST_F(PushedObjects, AreNotLearntFromAForceOfTheWrongSign) {
  simulate("push", "flipped", {"--flip-force"});
  expect_refused(
      run_pcavr({"identify", "friction", place("flipped"), "--scene", place("flipped-scene"),
                 "--tracked", place("flipped/tracked"), "-o", place("flipped.yaml")}),
      {"sign"});
  EXPECT_FALSE(fs::exists(place("flipped.yaml")));
  const CommandOutcome run = run_pcavr(replay_words("flipped", "flipped-run"));
  EXPECT_EQ(run.exit_code, 0) << run.standard_error;
  EXPECT_NE(read_file(fs::path(place("flipped-run")) / "run.yaml")->find("sign"),
            std::string::npos);
}

TEST_F(PushedObjects, AreIdentifiedThoughTheClocksAreATenthOfASecondApart) {
  simulate("probe", "late", {"--clock-offset", "0.1"});
  run_json({"identify", "friction", place("late"), "--scene", place("late-scene"), "--tracked",
            place("late/tracked"), "-o", place("late.yaml")});
  const json report = run_json(
      {"evaluate", place("late.yaml"), "--truth", place("late/truth"), "-o", place("late-report")});
  expect_within(report, "parameters.box_1.limiting_static_friction.error_relative", 0.02);
}

TEST_F(PushedObjects, AreKeptThoughTheToolsPoseJumps) {
  simulate("push", "jumps", {});
  const fs::path file = fs::path(place("jumps")) / "tool.csv";
  std::istringstream lines(read_file(file).value());
  std::string text;
  std::size_t row = 0;
  for (std::string line; std::getline(lines, line); ++row) {
    if (row % 1000 == 700) {
      const std::size_t comma = line.find(',');
      line = line.substr(0, comma + 1) + "9" + line.substr(line.find('.', comma));
    }
    text += line + '\n';
  }
  ASSERT_TRUE(write_file(file, text));
  const json report =
      replay_and_evaluate("jumps", "jumps-run", {"--parameters", place("parameters.yaml")});
  expect_within(report, "predicted.all.translation.max_m", 0.02);
}

TEST_F(PushedObjects, AreNotPredictedFromAbsurdParameters) {
  const fs::path file = place("absurd.yaml");
  fs::copy_file(place("parameters.yaml"), file);
  edit(file, "  mass: ", "  mass: -");
  std::vector<std::string> words = replay_words("push", "absurd-run");
  words.insert(words.end(), {"--parameters", file.string()});
  expect_refused(run_pcavr(words), {"absurd.yaml:", "mass"});
  EXPECT_FALSE(fs::exists(place("absurd-run")));
}

TEST(PositionError, OfTwoBoxesPushedAcrossADelayedLink) {
  PCAVR_NEEDS_SHARED_DATA("push_two_boxes/truth/camera.txt");
  const TemporaryFolder folder;
  const std::string recording = shared_data("push_two_boxes").string();
  const auto place = [&](const char* name) { return (folder.path() / name).string(); };
  run_json({"build", recording, "-o", place("scene")});
  run_json({"replay", recording, "--scene", place("scene"), "-o", place("tracking")});
  run_json({"identify", "friction", recording, "--scene", place("scene"), "--tracked",
            place("tracking"), "-o", place("parameters.yaml")});
  run_json({"replay", recording, "--scene", place("scene"), "--tracked", place("tracking"),
            "--parameters", place("parameters.yaml"), "-o", place("run")});
  const json report =
      run_json({"evaluate", place("run"), "--truth", recording + "/truth", "-o", place("report")});
  expect_within(report, "predicted.touched.translation.median_m", 0.0015);
  expect_within(report, "predicted.touched.translation.p95_m", 0.004);
  expect_within(report, "phases.measured.boundary.median_s", 0.060);
  expect_within(report, "corrections.share_of_streaming", 0.03);
}

}  // namespace
}  // namespace pcavr
