// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pcavr/base/core/output_file.hpp"
#include "pcavr/pipeline/augmented_frames.hpp"

#include "video_encoder.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Frames that are drawn in parallel before they are written: bounds the memory.
constexpr std::size_t kFramesPerBatch = 16;

Error write_error(const fs::path& file, const std::string& why) {
  return {.message = "can't be written: " + why,
          .file = file.string(),
          .hint = "choose a name in a folder that you may write to, on a disk with space left"};
}

/// Whether --force may replace the file: an MP4 file has a file type box first [ISO/IEC
/// 14496-12, 4.3].
bool is_mp4(const fs::path& file) {
  std::array<char, 8> header{};
  std::ifstream(file, std::ios::binary).read(header.data(), header.size());
  return std::string_view(header.data() + 4, 4) == "ftyp";
}

OutputFileOptions output_options(bool replace) {
  return {.replace = replace, .kind = "video", .is_replaceable = is_mp4};
}

/// A video under a temporary name in the target's folder, removed unless it is committed. Calls of
/// OpenCV may throw.
class VideoFile {
 public:
  VideoFile(const fs::path& target, OutputFile file, std::unique_ptr<VideoEncoder> encoder)
      : target_(target), file_(std::move(file)), encoder_(std::move(encoder)) {}

  /// Tries H.264 first, because browsers play it. It needs even image sides.
  [[nodiscard]] bool open(int width, int height, double rate) {
    using Codec = VideoEncoder::Codec;
    size_ = cv::Size(width / 2 * 2, height / 2 * 2);
    is_h264_ = encoder_->open(file_.path(), Codec::h264, rate, size_);
    return is_h264_ || encoder_->open(file_.path(), Codec::mpeg4, rate, size_);
  }

  void add(const ColorImage& picture) {
    cv::Mat rgb(picture.height(), picture.width(), CV_8UC3);
    std::copy_n(reinterpret_cast<const std::uint8_t*>(picture.pixels().data()),
                3 * picture.pixels().size(), rgb.data);
    cv::Mat bgr;
    cv::cvtColor(rgb(cv::Rect(cv::Point(), size_)), bgr, cv::COLOR_RGB2BGR);
    encoder_->add(bgr);
    ++pictures_;
  }

  [[nodiscard]] Expected<void> commit() {
    const std::size_t count = encoder_->finish();
    if (count != pictures_) {
      return write_error(target_, "only " + std::to_string(count) + " of " +
                                      std::to_string(pictures_) + " frames were written");
    }
    return file_.commit();
  }

  [[nodiscard]] bool is_h264() const { return is_h264_; }
  [[nodiscard]] std::size_t pictures() const { return pictures_; }

 private:
  fs::path target_;
  OutputFile file_;
  std::unique_ptr<VideoEncoder> encoder_;
  cv::Size size_;
  bool is_h264_ = false;
  std::size_t pictures_ = 0;
};

/// Draws a range of frames in parallel.
std::vector<std::optional<Expected<ColorImage>>> drawn(const AugmentedFrames& frames,
                                                       std::size_t first, std::size_t last,
                                                       Parallelism parallelism) {
  std::vector<std::optional<Expected<ColorImage>>> pictures(last - first);
  parallel_for(parallelism, pictures.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) pictures[i].emplace(frames.render(first + i));
  });
  return pictures;
}

Expected<AugmentedVideo> write_pictures(const AugmentedFrames& frames, const fs::path& target,
                                        const AugmentedVideoOptions& options,
                                        const Observer& observer) {
  Expected<OutputFile> output = OutputFile::create(target, output_options(options.replace));
  if (!output) return output.error();
  Expected<std::unique_ptr<VideoEncoder>> encoder = load_video_encoder();
  if (!encoder) return encoder.error();
  VideoFile file(target, *std::move(output), *std::move(encoder));
  AugmentedVideo video{.rate = frames.rate()};
  for (std::size_t first = 0; first < frames.size(); first += kFramesPerBatch) {
    const std::size_t last = std::min(first + kFramesPerBatch, frames.size());
    for (const auto& picture : drawn(frames, first, last, options.parallelism)) {
      if (!*picture && !options.skip_bad) return picture->error();
      if (!*picture) {
        ++video.left_out;
        continue;
      }
      const ColorImage& image = picture->value();
      if (file.pictures() == 0 && !file.open(image.width(), image.height(), video.rate)) {
        return write_error(target, "OpenCV's FFmpeg has no encoder for H.264 or MPEG-4");
      }
      file.add(image);
    }
    observer.on_progress("drawing", last, frames.size());
  }
  if (file.pictures() == 0) return write_error(target, "no frame decodes");
  video.pictures = file.pictures();
  video.is_h264 = file.is_h264();
  if (const auto done = file.commit(); !done) return done.error();
  return video;
}

}  // namespace

Expected<void> check_video_target(const fs::path& file, bool replace) {
  if (file.extension() != ".mp4") {
    return Error{.message = "is not the name of an MP4 video",
                 .file = file.string(),
                 .hint = "use the extension .mp4"};
  }
  return OutputFile::check(file, output_options(replace));
}

Expected<AugmentedVideo> write_augmented_video(const AugmentedFrames& frames, const fs::path& file,
                                               const AugmentedVideoOptions& options,
                                               const Observer& observer) {
  if (const auto target = check_video_target(file, options.replace); !target) {
    return target.error();
  }
  if (frames.placed() == 0) {
    return Error{.message = "no frame has a camera pose, so no body can be drawn",
                 .file = file.string(),
                 .hint = "omit --tracked, so that the camera is tracked"};
  }
  try {
    return write_pictures(frames, file, options, observer);
  } catch (const cv::Exception& exception) {
    return write_error(file, exception.err);
  }
}

}  // namespace pcavr
