// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/augmented_frames.hpp"

#include <fstream>
#include <memory>

#include <gtest/gtest.h>
#include <opencv2/videoio.hpp>

#include "pcavr/recordings/recording/frame_reader.hpp"

#include "pipeline/small_replay.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {
namespace fs = std::filesystem;

class AugmentedFramesTest : public testing::Test {
 protected:
  void SetUp() override {
    write_small_replay(folder_.path());
    recording_ = *read_recording(folder_.path() / "recording");
    scene_ = *read_scene_manifest(folder_.path() / "scene");
    ReplayOptions options;
    options.tracked = folder_.path() / "tracked";
    replay_ = *replay_recording(recording_, scene_, options);
  }

  [[nodiscard]] AugmentedFrames frames() const {
    return *AugmentedFrames::create(recording_, scene_, replay_);
  }
  [[nodiscard]] fs::path video() const { return folder_.path() / "out.mp4"; }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }

  const TemporaryFolder folder_;
  Recording recording_;
  SceneManifest scene_;
  Replay replay_;
};

bool is_same(const ColorImage& a, const ColorImage& b) {
  return std::equal(a.pixels().begin(), a.pixels().end(), b.pixels().begin(), b.pixels().end());
}

TEST_F(AugmentedFramesTest, DrawsTheBodyWhereTheCameraSeesIt) {
  const AugmentedFrames shown = frames();
  EXPECT_EQ(shown.size(), 5U);
  EXPECT_EQ(shown.placed(), 5U);
  EXPECT_DOUBLE_EQ(shown.rate(), 20.0);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto picture = shown.render(i);
    ASSERT_TRUE(picture) << picture.error().to_string();
    // Its top, from above; the camera's x axis is that of base.
    const Eigen::Vector3d top(0.5 + 0.01 * static_cast<double>(i), 0.0, 0.08);
    const Eigen::Vector2d pixel = a_small_camera().project(a_view_from_above().inverse() * top);
    const Rgb8 middle = (*picture)(static_cast<int>(std::lround(pixel.x())),
                                   static_cast<int>(std::lround(pixel.y())));
    EXPECT_GT(middle.r, middle.b + 20);  // ochre on gray
  }
}

TEST_F(AugmentedFramesTest, ShowsFramesWithoutACameraAsTheyWereRecorded) {
  replay_.camera_trajectory = {};
  const AugmentedFrames bare = frames();
  EXPECT_EQ(bare.placed(), 0U);
  EXPECT_TRUE(is_same(*bare.render(2), decode_frame(recording_, 2)->color));
  const auto written = write_augmented_video(bare, video());
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().to_string().find("camera"), std::string::npos);
  EXPECT_FALSE(fs::exists(video()));
}

TEST_F(AugmentedFramesTest, DrawsThePredictionSolidAndTheTrackedBodyAsALine) {
  const ColorImage tracked_only = *frames().render(0);
  TeleopRun run;
  run.shown = {{{0.0, Pose::from_translation({0.3, 0.2, 0.04})},
                {0.2, Pose::from_translation({0.3, 0.2, 0.04})}}};
  replay_.teleop = run;
  const ColorImage both = *frames().render(0);
  EXPECT_FALSE(is_same(both, tracked_only));
  const auto pixel_of = [](const Eigen::Vector3d& p_base) {
    const Eigen::Vector2d p = a_small_camera().project(a_view_from_above().inverse() * p_base);
    return Eigen::Vector2i(static_cast<int>(std::lround(p.x())),
                           static_cast<int>(std::lround(p.y())));
  };
  const Eigen::Vector2i predicted = pixel_of({0.3, 0.2, 0.08});
  const Eigen::Vector2i tracked = pixel_of({0.5, 0.0, 0.08});
  const ColorImage recorded = decode_frame(recording_, 0)->color;
  EXPECT_FALSE(both(predicted.x(), predicted.y()) == recorded(predicted.x(), predicted.y()));
  EXPECT_EQ(both(tracked.x(), tracked.y()), recorded(tracked.x(), tracked.y()));
}

TEST_F(AugmentedFramesTest, NeedsImages) {
  write_small_recording(folder_.path() / "bare", false);
  const auto bare =
      AugmentedFrames::create(*read_recording(folder_.path() / "bare"), scene_, replay_);
  ASSERT_FALSE(bare);
  EXPECT_NE(bare.error().to_string().find("bare"), std::string::npos);
}

TEST_F(AugmentedFramesTest, NamesTheImageThatDoesNotDecode) {
  const fs::path image = recording_.frames[3].color_path;
  std::ofstream(image.is_absolute() ? image : recording_.folder / image) << "no image";
  const AugmentedFrames shown = frames();
  EXPECT_TRUE(shown.render(2));
  const auto bad = shown.render(3);
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().to_string().find(image.filename().string()), std::string::npos);

  const auto strict = write_augmented_video(shown, video());
  ASSERT_FALSE(strict);
  EXPECT_FALSE(fs::exists(video()));
  const auto lenient = write_augmented_video(shown, video(), {.skip_bad = true});
  ASSERT_TRUE(lenient) << lenient.error().to_string();
  EXPECT_EQ(lenient->pictures, 4U);
  EXPECT_EQ(lenient->left_out, 1U);
}

TEST_F(AugmentedFramesTest, WritesAVideoOfAllFramesAndNoOtherFile) {
  const std::size_t before = files();
  const auto written = write_augmented_video(frames(), video());
  ASSERT_TRUE(written) << written.error().to_string();
  EXPECT_EQ(written->pictures, 5U);
  EXPECT_EQ(files(), before + 1);
  cv::VideoCapture read(video().string());
  ASSERT_TRUE(read.isOpened());
  EXPECT_NEAR(read.get(cv::CAP_PROP_FPS), 20.0, 0.01);
  EXPECT_EQ(read.get(cv::CAP_PROP_FRAME_WIDTH), 160);
  cv::Mat picture;
  int pictures = 0;
  while (read.read(picture)) ++pictures;
  EXPECT_EQ(pictures, 5);
}

TEST_F(AugmentedFramesTest, RefusesATargetThatCanNotBeWritten) {
  std::ofstream(video()) << "there already";
  EXPECT_FALSE(check_video_target(video(), false));
  EXPECT_FALSE(check_video_target(video(), true)) << "not a video";
  EXPECT_FALSE(check_video_target(folder_.path() / "out.avi", false));
  EXPECT_FALSE(check_video_target(folder_.path() / "nowhere" / "out.mp4", false));
  EXPECT_FALSE(write_augmented_video(frames(), video()));
  EXPECT_EQ(*read_file(video()), "there already");
}

}  // namespace
}  // namespace pcavr
