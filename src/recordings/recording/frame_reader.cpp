// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/frame_reader.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// What is nearer than the offset is no measurement.
void add_offset(double offset, DepthImage& depth) {
  if (offset == 0.0) return;
  for (float& z : depth.pixels()) {
    if (z > 0.0F) z = std::max(0.0F, z + static_cast<float>(offset));
  }
}

Expected<RgbdFrame> decode_with(ImageDecoder& decoder, const Recording& recording,
                                std::size_t index) {
  PCAVR_REQUIRE(index < recording.frames.size(), index, recording.frames.size());
  PCAVR_REQUIRE(recording.manifest.camera.has_value());
  const FrameFiles& files = recording.frames[index];
  const CameraModel& camera = *recording.manifest.camera;
  const auto image_at = [&](const std::filesystem::path& path) {
    return ExpectedImage{(recording.folder / path).string(), camera.width, camera.height};
  };
  const ExpectedImage color_image = image_at(files.color_path);
  const Expected<std::string> color_bytes = read_file(color_image.file);
  if (!color_bytes) return color_bytes.error();
  Expected<ColorImage> color = decoder.color(*color_bytes, color_image);
  if (!color) return color.error();

  if (files.depth_path.empty()) {
    return RgbdFrame{index, files.color_stamp, files.depth_stamp, *std::move(color),
                     DepthImage(camera.width, camera.height)};
  }
  const ExpectedImage depth_image = image_at(files.depth_path);
  const Expected<std::string> depth_bytes = read_file(depth_image.file);
  if (!depth_bytes) return depth_bytes.error();
  Expected<DepthImage> depth =
      decoder.depth(*depth_bytes, depth_image, recording.manifest.depth_scale);
  if (!depth) return depth.error();
  add_offset(recording.manifest.depth_offset, *depth);
  return RgbdFrame{index, files.color_stamp, files.depth_stamp, *std::move(color),
                   *std::move(depth)};
}

}  // namespace

Expected<RgbdFrame> decode_frame(const Recording& recording, std::size_t index) {
  ImageDecoder decoder;
  return decode_with(decoder, recording, index);
}

/// A bounded queue (backpressure) between the thread that decodes and the consumer.
struct FrameReader::Worker {
  Worker(const Recording& recording_in, const FrameReaderOptions& options_in)
      : recording(recording_in), options(options_in) {}

  ~Worker() {
    {
      const std::lock_guard lock(mutex);
      is_stopping = true;
    }
    has_room.notify_one();
    if (thread.joinable()) thread.join();
  }

  void start() {
    thread = std::thread([this] { decode_all(); });
  }

  void decode_all() {
    ImageDecoder decoder;
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
      if (!put(decode(decoder, i))) break;
    }
    const std::lock_guard lock(mutex);
    is_done = true;
    has_frame.notify_one();
  }

  [[nodiscard]] Expected<RgbdFrame> decode(ImageDecoder& decoder, std::size_t index) {
    try {
      Expected<RgbdFrame> frame = decode_with(decoder, recording, index);
      if (frame && !has_first_size(frame->depth)) return size_error(frame->depth, index);
      return frame;
    } catch (const std::bad_alloc&) {
      return Error{.message = "not enough memory for frame " + std::to_string(index),
                   .file = recording.folder.string(),
                   .hint = "free memory, or use smaller images"};
    }
  }

  bool has_first_size(const DepthImage& depth) {
    if (depth_width == 0) {
      depth_width = depth.width();
      depth_height = depth.height();
    }
    return depth.width() == depth_width && depth.height() == depth_height;
  }

  [[nodiscard]] Error size_error(const DepthImage& depth, std::size_t index) const {
    const auto text = [](int width, int height) {
      return std::to_string(width) + " x " + std::to_string(height);
    };
    return {.message = "is " + text(depth.width(), depth.height()) +
                       " pixels; the first depth image is " + text(depth_width, depth_height),
            .file = (recording.folder / recording.frames[index].depth_path).string(),
            .hint = "all depth images of a recording must have the same size"};
  }

  /// False when decoding should stop.
  bool put(Expected<RgbdFrame> frame) {
    std::unique_lock lock(mutex);
    if (!frame && options.skip_bad) {
      ++skipped;
      return !is_stopping;
    }
    const bool is_last = !frame;
    has_room.wait(lock, [&] {
      return is_stopping || frames.size() < static_cast<std::size_t>(options.max_prefetched);
    });
    if (is_stopping) return false;
    frames.push_back(std::move(frame));
    has_frame.notify_one();
    return !is_last;
  }

  Expected<std::optional<RgbdFrame>> take() {
    std::unique_lock lock(mutex);
    has_frame.wait(lock, [&] { return is_done || !frames.empty(); });
    if (frames.empty()) return std::optional<RgbdFrame>();
    Expected<RgbdFrame> frame = std::move(frames.front());
    frames.pop_front();
    has_room.notify_one();
    if (!frame) return frame.error();
    return std::optional(*std::move(frame));
  }

  const Recording& recording;
  const FrameReaderOptions options;
  std::mutex mutex;
  std::condition_variable has_room;
  std::condition_variable has_frame;
  std::deque<Expected<RgbdFrame>> frames;
  int depth_width = 0;  ///< of the first image that decoded; 0 before
  int depth_height = 0;
  std::size_t skipped = 0;
  bool is_stopping = false;
  bool is_done = false;
  std::thread thread;
};

FrameReader::FrameReader(const Recording& recording, const FrameReaderOptions& options)
    : worker_(std::make_unique<Worker>(recording, options)) {
  PCAVR_REQUIRE(options.max_prefetched >= 1, options.max_prefetched);
}

FrameReader::~FrameReader() = default;

Expected<std::optional<RgbdFrame>> FrameReader::next() {
  if (!worker_->thread.joinable()) worker_->start();
  return worker_->take();
}

std::size_t FrameReader::skipped() const {
  const std::lock_guard lock(worker_->mutex);
  return worker_->skipped;
}

}  // namespace pcavr
