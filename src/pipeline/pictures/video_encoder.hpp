// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// Writes one MP4 file. Its implementation is in a library of its own, because OpenCV's video
/// module needs FFmpeg, GStreamer and GDAL: loading these 230 libraries takes as long as everything
/// else that a command does before it starts. Calls of OpenCV may throw cv::Exception.
class VideoEncoder {
 public:
  VideoEncoder() = default;
  VideoEncoder(const VideoEncoder&) = delete;
  VideoEncoder& operator=(const VideoEncoder&) = delete;
  virtual ~VideoEncoder() = default;

  enum class Codec { h264, mpeg4 };
  /// False where there is no such encoder. `rate` in pictures per second, the sides even.
  [[nodiscard]] virtual bool open(const std::filesystem::path& file, Codec codec, double rate,
                                  cv::Size size) = 0;
  virtual void add(const cv::Mat& bgr) = 0;
  /// Closes the file and counts the pictures by reading it: OpenCV does not report a full disk.
  [[nodiscard]] virtual std::size_t finish() = 0;
};

/// Loads the library. Fails where it is missing or can't be loaded.
[[nodiscard]] Expected<std::unique_ptr<VideoEncoder>> load_video_encoder();

}  // namespace pcavr
