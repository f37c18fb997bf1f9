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

#include "video_file.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Frames that are drawn in parallel before they are written: bounds the memory.
constexpr std::size_t kFramesPerBatch = 16;

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
  Expected<VideoFile> created = VideoFile::create(target, options.replace);
  if (!created) return created.error();
  VideoFile file = *std::move(created);
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
      if (file.pictures() == 0) {
        if (const auto open = file.open(image.width(), image.height(), video.rate); !open)
          return open.error();
      }
      file.add(image);
    }
    observer.on_progress("drawing", last, frames.size());
  }
  if (file.pictures() == 0) return video_error(target, "no frame decodes");
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
  return OutputFile::check(file, video_output_options(replace));
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
    return video_error(file, exception.err);
  }
}

}  // namespace pcavr
