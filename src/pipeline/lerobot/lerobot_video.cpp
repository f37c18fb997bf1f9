// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "lerobot_video.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pcavr/recordings/recording/frame_reader.hpp"

#include "pipeline/pictures/video_file.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kStatsStep = 10;  ///< neighbouring pictures hardly differ

/// Sums over the pixels of pictures.
class PixelStats {
 public:
  void add(const ColorImage& picture) {
    for (const Rgb8& pixel : picture.pixels()) {
      const std::array channels{pixel.r, pixel.g, pixel.b};
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = channels[c] / 255.0;
        min_[c] = std::min(min_[c], value);
        max_[c] = std::max(max_[c], value);
        sum_[c] += value;
        squares_[c] += value * value;
      }
    }
    pixels_ += static_cast<double>(picture.pixels().size());
    ++pictures_;
  }
  void store(LerobotVideo& video) const {
    video.counted = pictures_;
    for (std::size_t c = 0; c < 3; ++c) {
      const double mean = sum_[c] / pixels_;
      const double variance = std::max(0.0, squares_[c] / pixels_ - mean * mean);
      video.channels[c] = {min_[c], max_[c], mean, std::sqrt(variance)};
    }
  }

 private:
  std::array<double, 3> min_{1.0, 1.0, 1.0}, max_{}, sum_{}, squares_{};
  double pixels_ = 0.0;
  std::size_t pictures_ = 0;
};

Error other_size(const Recording& recording, const ColorImage& picture) {
  return {.message = "its images have " + std::to_string(picture.width()) + " x " +
                     std::to_string(picture.height()) + " px, those of the first recording not",
          .file = recording.folder.string(),
          .hint = "export recordings of one camera, or each into its own data set"};
}

/// Adds the pictures of an episode, each as often as frames are nearest to it.
Expected<void> add_episode(const LerobotEpisode& episode, VideoFile& file, PixelStats& stats,
                           std::optional<std::pair<int, int>>& size) {
  std::optional<RgbdFrame> decoded;
  for (const LerobotFrame& frame : episode.frames) {
    if (!decoded || decoded->index != frame.image) {
      Expected<RgbdFrame> next = decode_frame(episode.recording, frame.image);
      if (!next) return next.error();
      decoded = *std::move(next);
    }
    const ColorImage& picture = decoded->color;
    const std::pair own(picture.width(), picture.height());
    if (!size) {
      if (const auto open = file.open(own.first, own.second, episode.rate); !open) return open;
      size = own;
    }
    if (*size != own) return other_size(episode.recording, picture);
    if (file.pictures() % kStatsStep == 0) stats.add(picture);
    file.add(picture);
  }
  return {};
}

}  // namespace

Expected<LerobotVideo> write_lerobot_video(const std::vector<LerobotEpisode>& episodes,
                                           const std::filesystem::path& file,
                                           const Observer& observer) {
  try {
    Expected<VideoFile> created = VideoFile::create(file, false);
    if (!created) return created.error();
    VideoFile video = *std::move(created);
    PixelStats stats;
    std::optional<std::pair<int, int>> size;
    for (std::size_t i = 0; i < episodes.size(); ++i) {
      if (const auto added = add_episode(episodes[i], video, stats, size); !added)
        return added.error();
      observer.on_progress("video", i + 1, episodes.size());
    }
    LerobotVideo result{.codec = video.is_h264() ? "h264" : "mpeg4",
                        .width = video.size().width,
                        .height = video.size().height};
    stats.store(result);
    if (const auto done = video.commit(); !done) return done.error();
    return result;
  } catch (const cv::Exception& failure) {
    return video_error(file, failure.err);
  }
}

}  // namespace pcavr
