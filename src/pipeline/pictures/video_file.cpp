// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "video_file.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Whether --force may replace the file: an MP4 file has a file type box first [ISO/IEC
/// 14496-12, 4.3].
bool is_mp4(const fs::path& file) {
  std::array<char, 8> header{};
  std::ifstream(file, std::ios::binary).read(header.data(), header.size());
  return std::string_view(header.data() + 4, 4) == "ftyp";
}

}  // namespace

Error video_error(const fs::path& file, const std::string& why) {
  return {.message = "can't be written: " + why,
          .file = file.string(),
          .hint = "choose a name in a folder that you may write to, on a disk with space left"};
}

OutputFileOptions video_output_options(bool replace) {
  return {.replace = replace, .kind = "video", .is_replaceable = is_mp4};
}

VideoFile::VideoFile(const fs::path& target, OutputFile file, std::unique_ptr<VideoEncoder> encoder)
    : target_(target), file_(std::move(file)), encoder_(std::move(encoder)) {}

Expected<VideoFile> VideoFile::create(const fs::path& target, bool replace) {
  Expected<OutputFile> output = OutputFile::create(target, video_output_options(replace));
  if (!output) return output.error();
  Expected<std::unique_ptr<VideoEncoder>> encoder = load_video_encoder();
  if (!encoder) return encoder.error();
  return VideoFile(target, *std::move(output), *std::move(encoder));
}

Expected<void> VideoFile::open(int width, int height, double rate) {
  using Codec = VideoEncoder::Codec;
  size_ = cv::Size(width / 2 * 2, height / 2 * 2);
  is_h264_ = encoder_->open(file_.path(), Codec::h264, rate, size_);
  if (is_h264_ || encoder_->open(file_.path(), Codec::mpeg4, rate, size_)) return {};
  return video_error(target_, "OpenCV's FFmpeg has no encoder for H.264 or MPEG-4");
}

void VideoFile::add(const ColorImage& picture) {
  cv::Mat rgb(picture.height(), picture.width(), CV_8UC3);
  std::copy_n(reinterpret_cast<const std::uint8_t*>(picture.pixels().data()),
              3 * picture.pixels().size(), rgb.data);
  cv::Mat bgr;
  cv::cvtColor(rgb(cv::Rect(cv::Point(), size_)), bgr, cv::COLOR_RGB2BGR);
  encoder_->add(bgr);
  ++pictures_;
}

Expected<void> VideoFile::commit() {
  const std::size_t count = encoder_->finish();
  if (count == pictures_) return file_.commit();
  return video_error(target_, "only " + std::to_string(count) + " of " + std::to_string(pictures_) +
                                  " frames were written");
}

}  // namespace pcavr
