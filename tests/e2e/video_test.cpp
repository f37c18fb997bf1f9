// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// `pcavr replay --video`: a video of a small recording, and its errors.
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

  [[nodiscard]] std::string path_of(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  [[nodiscard]] CommandOutcome record_video(const std::string& recording, const std::string& video,
                                            const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{
        "replay",    path_of(recording), "--scene", path_of("scene"), "-o",    path_of("run"),
        "--tracked", path_of("tracked"), "--video", path_of(video),   "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_pcavr(arguments);
  }
  /// One error line that contains `text`, exit code 1, and neither video nor run.
  void expect_refused(const CommandOutcome& outcome, const std::string& text) const {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_NE(outcome.standard_error.find(text), std::string::npos) << outcome.standard_error;
    EXPECT_FALSE(fs::exists(path_of("run")));
  }

  const TemporaryFolder folder_;
};

TEST_F(ReplayVideo, HoldsEveryFrameOfTheRecording) {
  const CommandOutcome outcome = record_video("recording", "out.mp4");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  const nlohmann::json json = nlohmann::json::parse(outcome.standard_output);
  EXPECT_EQ(json["video"]["pictures"], kSmallFrames);
  EXPECT_NEAR(json["video"]["rate"].get<double>(), 20.0, 1e-6);
  cv::VideoCapture video(path_of("out.mp4"));
  cv::Mat picture;
  int pictures = 0;
  while (video.read(picture)) ++pictures;
  EXPECT_EQ(pictures, kSmallFrames);
  EXPECT_TRUE(fs::exists(path_of("run/run.yaml")));
}

TEST_F(ReplayVideo, NeedsImages) {
  write_small_recording(path_of("bare"), false);
  expect_refused(record_video("bare", "out.mp4"), "images");
  EXPECT_FALSE(fs::exists(path_of("out.mp4")));
}

TEST_F(ReplayVideo, ReplacesAnExistingFileOnlyIfItIsAVideoAndForced) {
  std::ofstream(path_of("out.mp4")) << "mine";
  expect_refused(record_video("recording", "out.mp4"), "out.mp4");
  expect_refused(record_video("recording", "out.mp4", {"--force"}), "not a video");
  EXPECT_EQ(*read_file(path_of("out.mp4")), "mine");
  std::ofstream(path_of("out.mp4")) << std::string(
      "\0\0\0\x20"
      "ftypisom",
      12);
  expect_refused(record_video("recording", "out.mp4"), "out.mp4");
  EXPECT_EQ(record_video("recording", "out.mp4", {"--force"}).exit_code, 0);
  EXPECT_GT(fs::file_size(path_of("out.mp4")), 1000U);
}

TEST_F(ReplayVideo, RejectsAMissingFolderAndAnotherExtension) {
  expect_refused(record_video("recording", "nowhere/out.mp4"), "nowhere");
  expect_refused(record_video("recording", "out.gif"), ".mp4");
}

}  // namespace
}  // namespace pcavr
