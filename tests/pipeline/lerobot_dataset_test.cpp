// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A LeRobot data set of recordings with images: its video, and what refers to it. Numbers without
// images are tested with the real command, tests/e2e/export_command_test.cpp.
#include "pcavr/pipeline/lerobot_dataset.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/videoio.hpp>

#include "pcavr/base/core/output.hpp"

#include "pipeline/lerobot/column_stats.hpp"
#include "pipeline/small_replay.hpp"
#include "support/parquet_reader.hpp"

namespace pcavr {
namespace {

/// Each of the recording's images twice, at 40 frames per second.
LerobotEpisode small_episode(const std::filesystem::path& recording) {
  LerobotEpisode episode;
  episode.task = "push box";
  episode.rate = 40;
  episode.recording = read_recording(recording).value();
  for (std::size_t i = 0; i < 2 * kSmallFrames; ++i) {
    LerobotFrame frame;
    frame.state[0] = 0.1F * static_cast<float>(i);
    frame.image = i / 2;
    episode.frames.push_back(frame);
  }
  return episode;
}

class LerobotDataset : public testing::Test {
 protected:
  void SetUp() override { write_small_recording(folder_.path() / "recording"); }
  [[nodiscard]] LerobotEpisode episode() const {
    return small_episode(folder_.path() / "recording");
  }
  [[nodiscard]] std::filesystem::path output() const {
    std::filesystem::create_directories(folder_.path() / "dataset");
    return folder_.path() / "dataset";
  }

  const TemporaryFolder folder_;
};

TEST_F(LerobotDataset, HasTheImagesOfAllEpisodesInOneVideo) {
  const auto summary = write_lerobot_dataset({episode(), episode()}, output());
  ASSERT_TRUE(summary) << summary.error().to_string();
  EXPECT_EQ(summary->frames, 20U);
  cv::VideoCapture video(
      (output() / "videos/observation.images.color/chunk-000/file-000.mp4").string());
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 40.0, 1e-6);
  cv::Mat picture;
  int pictures = 0;
  while (video.read(picture)) {
    ++pictures;
    EXPECT_NEAR(cv::mean(picture)[0], 90.0, 6.0);  // as recorded, up to the encoder's quantiser
  }
  EXPECT_EQ(pictures, 20);
  const nlohmann::json info = nlohmann::json::parse(read_file(output() / "meta/info.json").value());
  const nlohmann::json& feature = info["features"]["observation.images.color"];
  EXPECT_EQ(feature["dtype"], "video");
  EXPECT_EQ(feature["shape"], nlohmann::json({120, 160, 3}));
  EXPECT_EQ(feature["info"]["video.codec"], summary->video_codec);
  const nlohmann::json stats =
      nlohmann::json::parse(read_file(output() / "meta/stats.json").value());
  EXPECT_NEAR(stats["observation.images.color"]["mean"][1][0][0], 90.0 / 255.0, 0.01);
}

TEST_F(LerobotDataset, SaysWhereAnEpisodeIsInTheVideo) {
  ASSERT_TRUE(write_lerobot_dataset({episode(), episode()}, output()));
  const nlohmann::json episodes =
      read_parquet(output() / "meta/episodes/chunk-000/file-000.parquet");
  if (episodes.is_null()) GTEST_SKIP() << kNoParquetReader;
  const std::string key = "videos/observation.images.color/";
  for (std::size_t e = 0; e < 2; ++e) {
    const nlohmann::json& row = episodes["rows"][e];
    EXPECT_EQ(row[key + "file_index"], "0");
    EXPECT_NEAR(row[key + "from_timestamp"].get<double>(), 0.25 * static_cast<double>(e), 1e-9);
    EXPECT_NEAR(row[key + "to_timestamp"].get<double>(), 0.25 * static_cast<double>(e + 1), 1e-9);
    EXPECT_EQ(row["dataset_from_index"], std::to_string(10 * e));
  }
}

TEST_F(LerobotDataset, RefusesEpisodesThatDiffer) {
  LerobotEpisode slower = episode();
  slower.rate = 20;
  const auto rates = write_lerobot_dataset({episode(), slower}, output());
  ASSERT_FALSE(rates);
  EXPECT_EQ(rates.error().hint, "give one rate with --fps");
  LerobotEpisode bare = episode();
  bare.recording.frames.clear();
  EXPECT_FALSE(write_lerobot_dataset({episode(), bare}, output()));
  LerobotEpisode broken = episode();
  ASSERT_TRUE(write_file(folder_.path() / "recording" / broken.recording.frames.back().color_path,
                         "no image"));
  EXPECT_FALSE(write_lerobot_dataset({broken}, output()));
}

TEST(ColumnStats, AreThoseOfTheNumbersThatThereAre) {
  std::vector<std::vector<double>> rows;
  for (int i = 0; i <= 100; ++i) rows.push_back({static_cast<double>(i), std::nan("")});
  rows.push_back({std::nan(""), 7.0});
  const ColumnStats stats = column_stats(rows, 2);
  const std::vector<std::pair<std::string, std::vector<double>>> expected{
      {"min", {0, 7}},  {"max", {100, 7}}, {"mean", {50, 7}}, {"std", {std::sqrt(850.0), 0}},
      {"q01", {1, 7}},  {"q10", {10, 7}},  {"q50", {50, 7}},  {"q90", {90, 7}},
      {"q99", {99, 7}}, {"count", {102}}};
  ASSERT_EQ(stats.size(), expected.size());
  for (std::size_t i = 0; i < stats.size(); ++i) {
    EXPECT_EQ(stats[i].first, expected[i].first);
    for (std::size_t k = 0; k < expected[i].second.size(); ++k)
      EXPECT_NEAR(stats[i].second[k], expected[i].second[k], 1e-9) << stats[i].first;
  }
}

}  // namespace
}  // namespace pcavr
