// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/frame_reader.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "recording/small_recording.hpp"

namespace pcavr {
namespace {

/// The recording without the second half of one depth image's bytes.
Recording with_truncated_depth(const SmallRecording& folder, int frame) {
  const Expected<std::string> bytes = read_file(folder.depth_file(frame));
  write_text(folder.depth_file(frame), bytes->substr(0, bytes->size() / 2));
  return read_recording(folder.path()).value();
}

TEST(DecodeFrame, GivesDepthInMetres) {
  const SmallRecording folder;
  const Recording recording = read_recording(folder.path()).value();
  const Expected<RgbdFrame> frame = decode_frame(recording, 2);
  ASSERT_TRUE(frame.has_value()) << frame.error().to_string();
  EXPECT_EQ(frame->index, 2u);
  EXPECT_EQ(frame->depth_stamp, milliseconds(1100));
  EXPECT_EQ(frame->depth(0, 0), 0.0f);
  // Stored in units of 0.2 mm, so the test's whole millimetres are restored up to float rounding.
  for (int x = 1; x < 16; ++x) EXPECT_NEAR(frame->depth(x, 5), small_depth(2)(x, 5), 1e-6);
  EXPECT_NEAR(frame->color(8, 6).g, 128, 2);  // JPEG of quality 95
}

TEST(DecodeFrame, NamesATruncatedDepthImage) {
  const SmallRecording folder;
  const Expected<RgbdFrame> frame = decode_frame(with_truncated_depth(folder, 1), 1);
  ASSERT_FALSE(frame.has_value());
  EXPECT_EQ(frame.error().file, folder.depth_file(1).string());
  EXPECT_FALSE(frame.error().hint.empty());
}

TEST(DecodeFrame, NamesAnImageThatWasRemoved) {
  const SmallRecording folder;
  const Recording recording = read_recording(folder.path()).value();
  std::filesystem::remove(folder.depth_file(0));
  const Expected<RgbdFrame> frame = decode_frame(recording, 0);
  ASSERT_FALSE(frame.has_value());
  EXPECT_EQ(frame.error().file, folder.depth_file(0).string());
}

TEST(DecodeFrame, RefusesAnIndexBeyondTheLast) {
  const SmallRecording folder;
  const Recording recording = read_recording(folder.path()).value();
  EXPECT_THROW((void)decode_frame(recording, 3), ContractError);
}

TEST(FrameReader, ReturnsEveryFrameInOrderAndThenNothing) {
  const SmallRecording folder;
  const Recording recording = read_recording(folder.path()).value();
  for (const int ahead : {1, 2, 10}) {
    FrameReader reader(recording, {.max_prefetched = ahead});
    for (std::size_t i = 0; i < 3; ++i) {
      const auto frame = reader.next();
      ASSERT_TRUE(frame.has_value() && frame->has_value());
      EXPECT_EQ((*frame)->index, i);
    }
    for (int i = 0; i < 2; ++i) {
      const auto none = reader.next();
      ASSERT_TRUE(none.has_value());
      EXPECT_FALSE(none->has_value());
    }
  }
}

TEST(FrameReader, MayBeDestroyedAtAnyTime) {
  const SmallRecording folder;
  const Recording recording = read_recording(folder.path()).value();
  for (int taken = 0; taken < 4; ++taken) {
    FrameReader reader(recording, {.max_prefetched = 1});
    for (int i = 0; i < taken; ++i) EXPECT_TRUE(reader.next().has_value());
  }
}

TEST(FrameReader, ReturnsAnErrorAndEnds) {
  const SmallRecording folder;
  const Recording recording = with_truncated_depth(folder, 1);
  FrameReader reader(recording);
  EXPECT_TRUE(reader.next().has_value());
  const auto failed = reader.next();
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().file, folder.depth_file(1).string());
  const auto after = reader.next();
  ASSERT_TRUE(after.has_value());
  EXPECT_FALSE(after->has_value());
}

TEST(FrameReader, SkipsAndCountsBadFramesWithSkipBad) {
  const SmallRecording folder;
  const Recording recording = with_truncated_depth(folder, 1);
  FrameReader reader(recording, {.skip_bad = true});
  EXPECT_EQ(reader.next().value()->index, 0u);
  EXPECT_EQ(reader.next().value()->index, 2u);
  EXPECT_FALSE(reader.next().value().has_value());
  EXPECT_EQ(reader.skipped(), 1u);
}

TEST(FrameReader, OfARecordingWithoutImagesGivesNothing) {
  const Recording recording;
  FrameReader reader(recording);
  EXPECT_FALSE(reader.next().value().has_value());
}

}  // namespace
}  // namespace pcavr
