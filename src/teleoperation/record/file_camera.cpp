// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <ctime>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/bag_import/camera_images.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/teleoperation/record/camera_source.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr double kDefaultRate = 30.0;  // [Hz]
constexpr std::string_view kFilePrefix = "file:";

class FileCamera final : public CameraSource {
 public:
  FileCamera(const fs::path& folder, std::vector<fs::path> files, double rate)
      : folder_(folder.string()), files_(std::move(files)), interval_(1.0 / rate) {}

  Expected<void> start() {
    const Expected<std::string_view> format = read(0);
    if (!format) return format.error();
    start_ = read_clock(CLOCK_MONOTONIC);
    return {};
  }

  Expected<std::optional<CameraFrame>> next(std::chrono::milliseconds timeout) override {
    const double now = read_clock(CLOCK_MONOTONIC);
    const auto due = static_cast<std::uint64_t>((now - start_) / interval_);
    if (due < frame_) {
      const double wait = start_ + static_cast<double>(frame_) * interval_ - now;
      std::this_thread::sleep_for(
          std::min(std::chrono::duration<double>(wait), std::chrono::duration<double>(timeout)));
      if (std::chrono::duration<double>(timeout).count() < wait) {
        return std::optional<CameraFrame>();
      }
    } else {
      // As a camera's driver does whose frames nobody takes.
      lost_ += due - frame_;
      frame_ = due;
    }
    const Expected<std::string_view> format = read(frame_ % files_.size());
    if (!format) return format.error();
    CameraFrame frame{.t = start_ + static_cast<double>(frame_) * interval_, .format = *format};
    frame.bytes = {reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size()};
    ++frame_;
    return std::optional(frame);
  }

  std::uint64_t lost() const override { return lost_; }
  std::string description() const override {
    return fmt::format("simulated camera of {}: {} images of {} x {} at {:.4g} Hz", folder_,
                       files_.size(), width_, height_, 1.0 / interval_);
  }
  int width() const override { return width_; }
  int height() const override { return height_; }

 private:
  /// The format of a file whose bytes are then in `bytes_`.
  Expected<std::string_view> read(std::size_t index) {
    const std::string file = files_[index].string();
    Expected<std::string> bytes = read_file(files_[index]);
    if (!bytes) return bytes.error();
    const RosMessage message(RosCompressedImage{
        .header = {},
        .format = {},
        .data = {reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()}});
    const ImageSize size = image_size(message);
    if (size.width == 0) {
      return Error{.message = "is neither a JPEG nor a PNG image",
                   .file = file,
                   .hint = "remove it from the simulated camera's folder"};
    }
    if (width_ == 0) {
      width_ = size.width;
      height_ = size.height;
    }
    if (size.width != width_ || size.height != height_) {
      return Error{.message = fmt::format("has {} x {} pixels, the images before it {} x {}",
                                          size.width, size.height, width_, height_),
                   .file = file,
                   .hint = "a camera's images have one size"};
    }
    bytes_ = std::move(*bytes);
    return std::string_view(bytes_.starts_with("\x89PNG") ? "png" : "jpeg");
  }

  const std::string folder_;
  const std::vector<fs::path> files_;
  const double interval_;  ///< [s]
  double start_ = 0.0;     ///< CLOCK_MONOTONIC [s] of frame 0
  std::uint64_t frame_ = 0;
  std::uint64_t lost_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::string bytes_;
};

}  // namespace

Expected<std::unique_ptr<CameraSource>> open_file_camera(const fs::path& folder,
                                                         const CameraRequest& request) {
  std::vector<fs::path> files;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    if (is_picture_file(entry->path())) files.push_back(entry->path());
  }
  if (code || files.empty()) {
    return Error{.message = code ? "can't be read: " + code.message() : "has no JPEG or PNG images",
                 .file = folder.string(),
                 .hint = "give a folder with a simulated camera's images"};
  }
  std::sort(files.begin(), files.end());
  auto camera =
      std::make_unique<FileCamera>(folder, std::move(files), request.rate.value_or(kDefaultRate));
  if (const Expected<void> started = camera->start(); !started) return started.error();
  const bool is_wanted =
      !request.width || (camera->width() == *request.width && camera->height() == *request.height);
  if (!is_wanted) {
    return Error{
        .message = fmt::format("has images of {} x {} pixels", camera->width(), camera->height()),
        .file = folder.string(),
        .place = "--camera-size",
        .hint = "omit it"};
  }
  return std::unique_ptr<CameraSource>(std::move(camera));
}

Expected<std::unique_ptr<CameraSource>> open_camera(const std::string& source,
                                                    const CameraRequest& request) {
  if (source.starts_with(kFilePrefix)) {
    return open_file_camera(source.substr(kFilePrefix.size()), request);
  }
  return open_v4l2_camera(source, request);
}

}  // namespace pcavr
