// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "pcavr/base/core/output_file.hpp"
#include "pcavr/base/geometry/image.hpp"

#include "video_encoder.hpp"

namespace pcavr {

/// An MP4 file under a temporary name in the target's folder, removed unless it is committed. Calls
/// may throw cv::Exception.
class VideoFile {
 public:
  [[nodiscard]] static Expected<VideoFile> create(const std::filesystem::path& target,
                                                  bool replace);

  /// Tries H.264 first, because browsers play it; then MPEG-4 part 2. It needs even image sides: an
  /// odd column or row is cut off. `rate` in pictures per second.
  [[nodiscard]] Expected<void> open(int width, int height, double rate);
  void add(const ColorImage& picture);
  /// An Error where not all pictures are in the file: a full disk.
  [[nodiscard]] Expected<void> commit();

  [[nodiscard]] bool is_h264() const { return is_h264_; }
  [[nodiscard]] std::size_t pictures() const { return pictures_; }
  [[nodiscard]] cv::Size size() const { return size_; }

 private:
  VideoFile(const std::filesystem::path& target, OutputFile file,
            std::unique_ptr<VideoEncoder> encoder);

  std::filesystem::path target_;
  OutputFile file_;
  std::unique_ptr<VideoEncoder> encoder_;
  cv::Size size_;
  bool is_h264_ = false;
  std::size_t pictures_ = 0;
};

[[nodiscard]] OutputFileOptions video_output_options(bool replace);
[[nodiscard]] Error video_error(const std::filesystem::path& file, const std::string& why);

}  // namespace pcavr
