// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// `pcavr replay --video`: a film of a small recording, and what keeps one from being made.
#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/videoio.hpp>

#include "pipeline/small_replay.hpp"
#include "support/command.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

class ReplayVideo : public testing::Test {
 protected:
  void SetUp() override { write_small_replay(folder_.path()); }

  [[nodiscard]] std::string place(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  [[nodiscard]] CommandOutcome film(const std::string& recording, const std::string& video,
                                    const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"replay",  place(recording), "--scene",   place("scene"),
                                   "-o",      place("run"),     "--tracked", place("tracked"),
                                   "--video", place(video),     "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_pcavr(words);
  }
  /// One line that holds `word`, exit code 1, and neither video nor run.
  void expect_refused(const CommandOutcome& outcome, const std::string& word) const {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_NE(outcome.standard_error.find(word), std::string::npos) << outcome.standard_error;
    EXPECT_FALSE(fs::exists(place("run")));
  }

  const TemporaryFolder folder_;
};

TEST_F(ReplayVideo, HoldsEveryFrameOfTheRecording) {
  const CommandOutcome outcome = film("recording", "out.mp4");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  const nlohmann::json json = nlohmann::json::parse(outcome.standard_output);
  EXPECT_EQ(json["video"]["pictures"], kSmallFrames);
  EXPECT_NEAR(json["video"]["rate"].get<double>(), 20.0, 1e-6);
  cv::VideoCapture video(place("out.mp4"));
  cv::Mat picture;
  int pictures = 0;
  while (video.read(picture)) ++pictures;
  EXPECT_EQ(pictures, kSmallFrames);
  EXPECT_TRUE(fs::exists(place("run/run.yaml")));
}

TEST_F(ReplayVideo, NeedsImages) {
  write_small_recording(place("bare"), false);
  expect_refused(film("bare", "out.mp4"), "images");
  EXPECT_FALSE(fs::exists(place("out.mp4")));
}

TEST_F(ReplayVideo, KeepsAFileThatIsThereUnlessItIsAVideoAndForced) {
  std::ofstream(place("out.mp4")) << "mine";
  expect_refused(film("recording", "out.mp4"), "out.mp4");
  expect_refused(film("recording", "out.mp4", {"--force"}), "not a video");
  EXPECT_EQ(*read_file(place("out.mp4")), "mine");
  std::ofstream(place("out.mp4")) << std::string(
      "\0\0\0\x20"
      "ftypisom",
      12);
  expect_refused(film("recording", "out.mp4"), "out.mp4");
  EXPECT_EQ(film("recording", "out.mp4", {"--force"}).exit_code, 0);
  EXPECT_GT(fs::file_size(place("out.mp4")), 1000U);
}

TEST_F(ReplayVideo, RefusesAFolderThatIsNotThereAndANameThatIsNoVideo) {
  expect_refused(film("recording", "nowhere/out.mp4"), "nowhere");
  expect_refused(film("recording", "out.gif"), ".mp4");
}

}  // namespace
}  // namespace pcavr
