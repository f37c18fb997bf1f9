// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/line_counts.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "recording/small_recording.hpp"

namespace pcavr {
namespace {

/// Three poses of a tool and no images, as pcavr itself writes them.
class WrittenRecording : public testing::Test {
 protected:
  void SetUp() override {
    Trajectory T_base_tool;
    for (int i = 0; i < 3; ++i) {
      T_base_tool.append(milliseconds(100 * i), Pose::from_translation({0.125 * i, 0.0, 0.25}));
    }
    RecordingWriter writer(folder_.path(), {});
    ASSERT_TRUE(writer.write_tool(T_base_tool));
    ASSERT_TRUE(writer.finish());
    text_ = read_file(tool()).value();
  }

  [[nodiscard]] std::filesystem::path tool() const { return folder_.path() / "tool.csv"; }

  TemporaryFolder folder_;
  std::string text_;
};

TEST_F(WrittenRecording, HasALineCountForEachTextFile) {
  EXPECT_EQ(read_line_counts(folder_.path() / kWrittenFile).value(), LineCounts({{"tool.csv", 4}}));
  EXPECT_TRUE(read_recording(folder_.path()).has_value());
}

TEST_F(WrittenRecording, IsRefusedWhereverItIsTruncated) {
  // The cuts include some inside the last number, and before the very last byte, which leave four
  // valid rows.
  for (std::size_t size = text_.find('\n') + 1; size < text_.size(); ++size) {
    write_text(tool(), text_.substr(0, size));
    const Expected<Recording> recording = read_recording(folder_.path());
    ASSERT_FALSE(recording.has_value()) << "truncated to " << size << " of " << text_.size();
    EXPECT_EQ(recording.error().file, tool().string());
  }
  write_text(tool(), text_.substr(0, text_.size() - 1));
  const std::string line = read_recording(folder_.path()).error().to_string();
  EXPECT_NE(line.find("it ends inside line 4, and 4 were written"), line.npos) << line;
  EXPECT_NE(line.find("remove written.yaml"), line.npos) << line;
}

TEST_F(WrittenRecording, IsRefusedWithAnExtraRow) {
  write_text(tool(), text_ + "0.9,0,0,0,0,0,0,1\n");
  const std::string line = read_recording(folder_.path()).error().to_string();
  EXPECT_NE(line.find("it has 5 lines, and 4 were written"), line.npos) << line;
}

TEST_F(WrittenRecording, IsReadWithAWarningWhereBadRowsMayBeSkipped) {
  write_text(tool(), text_ + "0.9,0,0,0,0,0,0,1\n");
  ReadOptions options;
  options.skip_bad = true;
  const Expected<Recording> recording = read_recording(folder_.path(), options);
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  ASSERT_EQ(recording->warnings.size(), 1U);
  EXPECT_NE(recording->warnings[0].find("5 lines"), std::string::npos);
}

TEST_F(WrittenRecording, MayBeChangedWithoutItsCounts) {
  write_text(tool(), text_ + "0.9,0,0,0,0,0,0,1\n");
  std::filesystem::remove(folder_.path() / kWrittenFile);
  EXPECT_TRUE(read_recording(folder_.path()).has_value());
}

TEST_F(WrittenRecording, MayLackAFileAltogether) {
  std::filesystem::remove(tool());
  EXPECT_TRUE(read_recording(folder_.path()).has_value());
}

TEST(LineCounts, DoNotLeaveTheFolder) {
  const TemporaryFolder folder;
  write_text(folder.path() / "run.yaml", "lines:\n  ../secret.txt: 3\n");
  const Expected<void> checked = check_line_counts(folder.path() / "run.yaml");
  ASSERT_FALSE(checked.has_value());
  EXPECT_EQ(checked.error().line, 2);
}

TEST(LineCounts, AreAbsentFromWhatAnOlderVersionWrote) {
  const TemporaryFolder folder;
  write_text(folder.path() / "run.yaml", "format: pcavr-run/1\n");
  EXPECT_FALSE(read_line_counts(folder.path() / "run.yaml").value().has_value());
  EXPECT_TRUE(check_line_counts(folder.path() / "run.yaml").has_value());
}

TEST(LineCounts, IgnoreTruth) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "truth");
  write_text(folder.path() / "truth/camera.txt", "1 0 0 0 0 0 0 1\n");
  write_text(folder.path() / "a.txt", "1\n2\n");
  EXPECT_EQ(count_lines(folder.path()).value(), LineCounts({{"a.txt", 2}}));
}

TEST(RecordingWriter, QuotesANameThatContainsASpace) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder.path(), {.camera = small_camera(), .depth_scale = 5000.0});
  const ColorImage gray(16, 12, Rgb8{128, 128, 128});
  ASSERT_TRUE(writer.add_frame(milliseconds(0), gray, milliseconds(0), small_depth(0)));
  ASSERT_TRUE(writer.add_encoded_frame(milliseconds(50), {"colour", ".a b.jpg"}, milliseconds(50),
                                       {"depth", ".#\".png"}));
  ASSERT_TRUE(writer.finish());
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  ASSERT_EQ(recording->frames.size(), 2U);
  EXPECT_EQ(recording->frames[1].color_path, "rgb/0.050000.a b.jpg");
  EXPECT_EQ(recording->frames[1].depth_path, "depth/0.050000.#\".png");
}

}  // namespace
}  // namespace pcavr
