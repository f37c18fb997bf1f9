// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "picture_encoder.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/base/geometry/image_scaling.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

constexpr int kMaxQuality = 90;
constexpr int kMinQuality = 20;  // below it a smaller picture shows more
constexpr int kQualityStep = 10;
constexpr int kMinWidth = 80;         // [px] the coarsest picture
constexpr double kWellBelow = 0.6;    // of the permitted bytes: the next may be better
constexpr std::size_t kHeader = 104;  // [bytes] of a picture's message beside the JPEG

/// The camera of the image reduced by this factor.
LinkPictureCamera camera_of(const CameraModel& full, int reduction) {
  const CameraModel camera = full.downsampled(reduction);
  LinkPictureCamera sent{.fx = static_cast<float>(camera.fx),
                         .fy = static_cast<float>(camera.fy),
                         .cx = static_cast<float>(camera.cx),
                         .cy = static_cast<float>(camera.cy),
                         .lens = camera.distortion.model()};
  const std::span<const double> coefficients = camera.distortion.coefficients();
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    sent.coefficients[i] = static_cast<float>(coefficients[i]);
  }
  return sent;
}

}  // namespace

Expected<LinkPicture> encode_picture(const CameraPicture& picture, std::size_t max_bytes,
                                     int& quality) {
  const std::size_t allowed = std::min(max_bytes, kMaxLinkPictureBytes) - kHeader;
  quality = std::clamp(quality, kMinQuality, kMaxQuality);
  ColorImage smaller;
  const ColorImage* image = &picture.image;
  int reduction = 1;
  for (;;) {
    Expected<std::string> jpeg = encode_color(*image, quality);
    if (!jpeg) return jpeg.error();
    const bool is_coarsest = quality == kMinQuality && image->width() < 2 * kMinWidth;
    if (jpeg->size() <= allowed || is_coarsest) {
      if (static_cast<double>(jpeg->size()) < kWellBelow * static_cast<double>(allowed)) {
        quality = std::min(quality + kQualityStep, kMaxQuality);
      }
      return LinkPicture{
          picture.t,
          static_cast<std::uint16_t>(image->width()),
          static_cast<std::uint16_t>(image->height()),
          {jpeg->begin(), jpeg->end()},
          picture.camera ? std::optional(camera_of(*picture.camera, reduction)) : std::nullopt};
    }
    if (quality > kMinQuality) {
      quality = std::max(quality - kQualityStep, kMinQuality);
    } else {
      reduction *= 2;
      smaller = halved(*image);
      image = &smaller;
    }
  }
}

PictureEncoder::PictureEncoder(PictureSource& source)
    : source_(source), thread_([this] { run(); }) {}

PictureEncoder::~PictureEncoder() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  requested_.notify_all();
  thread_.join();
}

void PictureEncoder::request(double t, std::size_t max_bytes) {
  {
    const std::lock_guard lock(mutex_);
    if (request_ || made_) return;
    request_ = Request{t, std::max(max_bytes, 2 * kHeader)};
  }
  requested_.notify_all();
}

std::optional<LinkPicture> PictureEncoder::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(made_, std::nullopt);
}

std::optional<std::string> PictureEncoder::take_fault() {
  const std::lock_guard lock(mutex_);
  return std::exchange(fault_, std::nullopt);
}

Expected<std::optional<LinkPicture>> PictureEncoder::newest(const Request& wanted, int& quality) {
  Expected<std::optional<CameraPicture>> picture = source_.newest(wanted.t);
  if (!picture) return picture.error();
  if (!*picture) return std::optional<LinkPicture>();
  Expected<LinkPicture> encoded = encode_picture(**picture, wanted.max_bytes, quality);
  if (!encoded) return encoded.error();
  return std::optional(*std::move(encoded));
}

void PictureEncoder::run() {
  int quality = kMaxQuality;
  std::unique_lock lock(mutex_);
  for (;;) {
    requested_.wait(lock, [this] { return is_stopped_ || request_; });
    if (is_stopped_) return;
    const Request wanted = *request_;
    lock.unlock();
    auto made = caught([&] { return newest(wanted, quality); });
    lock.lock();
    request_.reset();
    if (!made) {
      fault_ = made.error().to_string();
    } else if (!*made) {
      fault_ = made->error().to_string();
    } else {
      made_ = std::move(**made);
    }
  }
}

}  // namespace pcavr
