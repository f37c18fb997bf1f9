// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/line_counts.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {

/// A camera with few pixels, so that images are fast.
inline CameraModel small_camera() {
  return {.width = 16, .height = 12, .fx = 15.0, .fy = 15.0, .cx = 7.5, .cy = 5.5};
}

inline Stamp milliseconds(std::int64_t count) { return {count * 1'000'000}; }

/// Depth that identifies column and frame: 1 m + 1 mm per column + 10 mm per frame, 0 in the
/// corner.
inline DepthImage small_depth(int frame) {
  DepthImage depth(16, 12);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 16; ++x) {
      depth(x, y) = 1.0f + 0.001f * static_cast<float>(x) + 0.01f * static_cast<float>(frame);
    }
  }
  depth(0, 0) = 0.0f;
  return depth;
}

inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// A valid recording of three frames, 50 ms apart, in a temporary folder.
class SmallRecording {
 public:
  SmallRecording() {
    RecordingWriter writer(path(), {.camera = small_camera(), .depth_scale = 5000.0});
    const ColorImage gray(16, 12, Rgb8{128, 128, 128});
    for (int i = 0; i < 3; ++i) {
      const Stamp stamp = milliseconds(1000 + 50 * i);
      EXPECT_TRUE(writer.add_frame(stamp, gray, stamp, small_depth(i)).has_value());
    }
    EXPECT_TRUE(writer.finish().has_value());
    // Makes it a user's recording, whose files may change.
    std::filesystem::remove(path() / kWrittenFile);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  void write(const std::string& name, const std::string& text) const {
    write_text(path() / name, text);
  }
  [[nodiscard]] std::filesystem::path depth_file(int frame) const {
    return path() / ("depth/1." +
                     std::string(frame == 0   ? "00"
                                 : frame == 1 ? "05"
                                              : "10") +
                     "0000.png");
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace pcavr
