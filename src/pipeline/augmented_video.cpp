// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include "pcavr/pipeline/augmented_frames.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Drawn before the next ones are begun: bounds the memory.
constexpr std::size_t kFramesAtOnce = 16;

Error can_not_write(const fs::path& file, const std::string& why) {
  return {.message = "can't be written: " + why,
          .file = file.string(),
          .hint = "choose a name in a folder that you may write to, on a disk with space left"};
}

/// A video under a temporary name beside its own, gone unless it is committed. Calls of OpenCV may
/// throw.
class VideoFile {
 public:
  explicit VideoFile(const fs::path& target)
      : target_(target),
        temporary_(
            fs::absolute(target).parent_path() /
            ("." + target.stem().string() + ".partial-" + std::to_string(::getpid()) + ".mp4")) {}
  ~VideoFile() {
    std::error_code ignored;
    fs::remove(temporary_, ignored);
  }
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// H.264 first, because browsers play it. Its pictures have even sides.
  [[nodiscard]] bool open(int width, int height, double rate) {
    size_ = cv::Size(width / 2 * 2, height / 2 * 2);
    is_h264_ = open_as("avc1", rate);
    return is_h264_ || open_as("mp4v", rate);
  }

  void add(const ColorImage& picture) {
    cv::Mat rgb(picture.height(), picture.width(), CV_8UC3);
    std::copy_n(reinterpret_cast<const std::uint8_t*>(picture.pixels().data()),
                3 * picture.pixels().size(), rgb.data);
    cv::Mat bgr;
    cv::cvtColor(rgb(cv::Rect(cv::Point(), size_)), bgr, cv::COLOR_RGB2BGR);
    writer_.write(bgr);
    ++pictures_;
  }

  /// The writer does not tell of a full disk: what was written is opened and counted.
  [[nodiscard]] Expected<void> commit() {
    writer_.release();
    cv::VideoCapture written(temporary_.string(), cv::CAP_FFMPEG);
    const double count = written.isOpened() ? written.get(cv::CAP_PROP_FRAME_COUNT) : 0.0;
    written.release();
    if (std::lround(count) != static_cast<long>(pictures_)) {
      return can_not_write(target_, "only " + std::to_string(std::lround(count)) + " of " +
                                        std::to_string(pictures_) + " pictures reached the disk");
    }
    std::error_code code;
    fs::rename(temporary_, target_, code);
    if (code) return can_not_write(target_, code.message());
    return {};
  }

  [[nodiscard]] bool is_h264() const { return is_h264_; }
  [[nodiscard]] std::size_t pictures() const { return pictures_; }

 private:
  [[nodiscard]] bool open_as(const char* codec, double rate) {
    const int code = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
    return writer_.open(temporary_.string(), cv::CAP_FFMPEG, code, rate, size_);
  }

  fs::path target_;
  fs::path temporary_;
  cv::Size size_;
  cv::VideoWriter writer_;
  bool is_h264_ = false;
  std::size_t pictures_ = 0;
};

/// Some frames, drawn side by side.
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
  VideoFile file(target);
  AugmentedVideo video{.rate = frames.rate()};
  for (std::size_t first = 0; first < frames.size(); first += kFramesAtOnce) {
    const std::size_t last = std::min(first + kFramesAtOnce, frames.size());
    for (const auto& picture : drawn(frames, first, last, options.parallelism)) {
      if (!*picture && !options.skip_bad) return picture->error();
      if (!*picture) {
        ++video.left_out;
        continue;
      }
      const ColorImage& image = picture->value();
      if (file.pictures() == 0 && !file.open(image.width(), image.height(), video.rate)) {
        return can_not_write(target, "OpenCV's FFmpeg can't make such a file here");
      }
      file.add(image);
    }
    observer.on_progress("drawing", last, frames.size());
  }
  if (file.pictures() == 0) return can_not_write(target, "no frame decodes");
  video.pictures = file.pictures();
  video.is_h264 = file.is_h264();
  if (const auto done = file.commit(); !done) return done.error();
  return video;
}

}  // namespace

Expected<void> check_video_target(const fs::path& file, bool replace) {
  std::error_code code;
  if (file.extension() != ".mp4") {
    return Error{
        .message = "is no name for a video", .file = file.string(), .hint = "end it in .mp4"};
  }
  if (fs::is_directory(file, code)) {
    return Error{.message = "is a folder", .file = file.string(), .hint = "choose another name"};
  }
  if (!replace && fs::exists(file, code)) {
    return Error{.message = "is there already",
                 .file = file.string(),
                 .hint = "choose another name, or say --force to replace it"};
  }
  const fs::path folder = fs::absolute(file).parent_path();
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    return can_not_write(file, std::system_category().message(errno));
  }
  return {};
}

Expected<AugmentedVideo> write_augmented_video(const AugmentedFrames& frames, const fs::path& file,
                                               const AugmentedVideoOptions& options,
                                               const Observer& observer) {
  if (const auto sound = check_video_target(file, options.replace); !sound) return sound.error();
  if (frames.placed() == 0) {
    return Error{.message = "no frame's camera is known, so nothing can be drawn over it",
                 .file = file.string(),
                 .hint = "leave --tracked out, so that the camera's way is found"};
  }
  try {
    return write_pictures(frames, file, options, observer);
  } catch (const cv::Exception& exception) {
    return can_not_write(file, exception.err);
  }
}

}  // namespace pcavr
