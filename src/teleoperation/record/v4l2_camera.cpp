// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "v4l2_camera.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <linux/videodev2.h>

#include "pcavr/recordings/bag_import/camera_images.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

namespace pcavr {
namespace {

constexpr int kMaxIoErrors = 100;
constexpr std::chrono::milliseconds kIoErrorWait(10);
constexpr std::uint32_t kBuffers = 4;      // at 30 Hz the encoder may be late by 0.1 s
constexpr std::uint32_t kMinBuffers = 2;   // one is filled while the other is read
constexpr std::uint32_t kMaxFormats = 64;  // asked for: a driver must not keep us asking

std::string fourcc_text(std::uint32_t code) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>((code >> (8 * i)) & 0x7FU);
    if (c > ' ') text += c;
  }
  return text;
}

class V4l2Camera final : public CameraSource {
 public:
  V4l2Camera(std::unique_ptr<VideoDevice> device, std::string name)
      : device_(std::move(device)), name_(std::move(name)) {}
  ~V4l2Camera() override {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (is_streaming_) (void)device_->control(VIDIOC_STREAMOFF, &type);
  }

  Expected<void> start(const CameraRequest& request) {
    if (Expected<void> done = check_capabilities(); !done) return done;
    if (Expected<void> done = set_format(request); !done) return done;
    set_rate(request);
    if (Expected<void> done = map_buffers(); !done) return done;
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (const int code = device_->control(VIDIOC_STREAMON, &type)) {
      return failure("can't start to stream", code);
    }
    is_streaming_ = true;
    return {};
  }

  Expected<std::optional<CameraFrame>> next(std::chrono::milliseconds timeout) override {
    if (!device_->wait(timeout)) return std::optional<CameraFrame>();
    v4l2_buffer buffer = make_buffer(0);
    if (const int code = device_->control(VIDIOC_DQBUF, &buffer)) {
      if (code == EAGAIN) return std::optional<CameraFrame>();
      // The driver lost the frame, and goes on; or its queue has failed for good: it says so at
      // once.
      if (code == EIO && ++io_errors_ < kMaxIoErrors) {
        std::this_thread::sleep_for(kIoErrorWait);
        return damaged();
      }
      return failure("was disconnected", code);
    }
    io_errors_ = 0;
    const bool is_whole = take(buffer);
    v4l2_buffer returned = make_buffer(buffer.index);
    if (const int code = device_->control(VIDIOC_QBUF, &returned)) {
      return failure("was disconnected", code);
    }
    if (!is_whole) return damaged();
    return encode(time_of(buffer));
  }

  std::uint64_t lost() const override { return lost_; }
  std::string description() const override {
    const std::string rate = rate_ > 0.0 ? fmt::format(" at {:.4g} Hz", rate_) : std::string();
    return fmt::format("{}: {} x {} {}{}", name_, width_, height_, fourcc_text(format_), rate);
  }
  int width() const override { return width_; }
  int height() const override { return height_; }

 private:
  Error failure(const std::string& what, int code) const {
    return {.message = what + ": " + std::strerror(code),
            .file = name_,
            .hint = code == EBUSY ? "end the program that uses it" : "check the connection"};
  }

  static v4l2_buffer make_buffer(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
  }

  Expected<void> check_capabilities() {
    v4l2_capability found{};
    if (const int code = device_->control(VIDIOC_QUERYCAP, &found)) {
      return failure("is not a video device", code);
    }
    // A device may have several nodes; only some of them capture.
    const bool has_own = (found.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
    const std::uint32_t own = has_own ? found.device_caps : found.capabilities;
    if ((own & V4L2_CAP_VIDEO_CAPTURE) != 0 && (own & V4L2_CAP_STREAMING) != 0) return {};
    return Error{.message = "gives no images: it is another node of the device",
                 .file = name_,
                 .hint = "try the other /dev/video* of this camera"};
  }

  Expected<void> set_format(const CameraRequest& request) {
    std::set<std::uint32_t> offered;
    for (std::uint32_t i = 0; i < kMaxFormats; ++i) {
      v4l2_fmtdesc entry{};
      entry.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      entry.index = i;
      if (device_->control(VIDIOC_ENUM_FMT, &entry) != 0) break;
      offered.insert(entry.pixelformat);
    }
    if (offered.contains(V4L2_PIX_FMT_MJPEG)) {
      format_ = V4L2_PIX_FMT_MJPEG;
    } else if (offered.contains(V4L2_PIX_FMT_YUYV)) {
      format_ = V4L2_PIX_FMT_YUYV;
    } else {
      std::vector<std::string> names;
      for (const std::uint32_t code : offered) names.push_back(fourcc_text(code));
      return Error{.message = fmt::format(
                       "offers neither MJPG nor YUYV, but {}",
                       names.empty() ? "no format" : fmt::format("{}", fmt::join(names, ", "))),
                   .file = name_,
                   .hint = "use a camera with one of these"};
    }
    v4l2_format wanted{};
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (const int code = device_->control(VIDIOC_G_FMT, &wanted)) {
      return failure("does not state its format", code);
    }
    v4l2_pix_format& image = wanted.fmt.pix;
    image.pixelformat = format_;
    image.field = V4L2_FIELD_ANY;
    image.bytesperline = 0;
    image.sizeimage = 0;
    if (request.width && request.height) {
      image.width = static_cast<std::uint32_t>(*request.width);
      image.height = static_cast<std::uint32_t>(*request.height);
    }
    if (const int code = device_->control(VIDIOC_S_FMT, &wanted)) {
      return failure("can't be set to " + fourcc_text(format_), code);
    }
    return check_format(image, request);
  }

  /// The driver changes what it can't do: what it gives counts.
  Expected<void> check_format(const v4l2_pix_format& image, const CameraRequest& request) {
    width_ = static_cast<int>(image.width);
    height_ = static_cast<int>(image.height);
    stride_ = std::max(image.bytesperline, 2 * image.width);
    if (image.pixelformat != format_) {
      return Error{.message = fmt::format("gives {} in place of {}", fourcc_text(image.pixelformat),
                                          fourcc_text(format_)),
                   .file = name_,
                   .hint = "give another --camera-size"};
    }
    constexpr std::uint32_t kMaxSide = 16384;
    const bool is_possible = image.width >= 2 && image.height >= 2 && image.width <= kMaxSide &&
                             image.height <= kMaxSide;
    const bool is_wanted =
        !request.width || (width_ == *request.width && height_ == *request.height);
    if (is_possible && is_wanted) return {};
    return Error{.message = fmt::format("gives {} x {} pixels in place of those asked for",
                                        image.width, image.height),
                 .file = name_,
                 .place = "--camera-size",
                 .hint = fmt::format("give --camera-size {}x{}, or another that it has",
                                     image.width, image.height)};
  }

  /// Cameras may ignore it, or have no choice: description() states what they say.
  void set_rate(const CameraRequest& request) {
    v4l2_streamparm wanted{};
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    v4l2_fract& interval = wanted.parm.capture.timeperframe;
    if (device_->control(VIDIOC_G_PARM, &wanted) != 0) return;
    if (request.rate) {
      constexpr std::uint32_t kTicks = 1000;
      interval.numerator = kTicks;
      interval.denominator = static_cast<std::uint32_t>(std::lround(kTicks * *request.rate));
      if (device_->control(VIDIOC_S_PARM, &wanted) != 0) return;
    }
    if (interval.numerator > 0) rate_ = double(interval.denominator) / interval.numerator;
  }

  Expected<void> map_buffers() {
    v4l2_requestbuffers wanted{};
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    wanted.memory = V4L2_MEMORY_MMAP;
    wanted.count = kBuffers;
    if (const int code = device_->control(VIDIOC_REQBUFS, &wanted)) {
      return failure("has no buffers to stream by mmap", code);
    }
    if (wanted.count < kMinBuffers) return failure("has too little memory", ENOMEM);
    for (std::uint32_t i = 0; i < wanted.count; ++i) {
      v4l2_buffer buffer = make_buffer(i);
      if (const int code = device_->control(VIDIOC_QUERYBUF, &buffer)) {
        return failure("does not state its buffers", code);
      }
      const std::uint8_t* const bytes = device_->map(buffer.length, buffer.m.offset);
      if (bytes == nullptr) return failure("can't be mapped", errno);
      buffers_.push_back({bytes, buffer.length});
      v4l2_buffer queued = make_buffer(i);
      if (const int code = device_->control(VIDIOC_QBUF, &queued)) {
        return failure("does not take its buffers", code);
      }
    }
    return {};
  }

  /// Copies the buffer's bytes, and counts the frames that are missing before it. False if it is
  /// damaged.
  bool take(const v4l2_buffer& buffer) {
    if (last_sequence_) {
      const std::uint32_t step = buffer.sequence - *last_sequence_;  // wraps around
      constexpr std::uint32_t kMaxStep = 1U << 31U;  // beyond, the driver has begun anew
      if (step > 1 && step < kMaxStep) lost_ += step - 1;
    }
    last_sequence_ = buffer.sequence;
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || buffer.index >= buffers_.size()) return false;
    const std::span<const std::uint8_t> whole = buffers_[buffer.index];
    const auto used = whole.first(std::min<std::size_t>(buffer.bytesused, whole.size()));
    bytes_.assign(used.begin(), used.end());
    return is_image();
  }

  [[nodiscard]] bool is_image() const {
    if (format_ == V4L2_PIX_FMT_MJPEG) {
      return bytes_.size() > 4 && bytes_[0] == 0xFF && bytes_[1] == 0xD8;
    }
    return bytes_.size() >= std::size_t{stride_} * static_cast<std::size_t>(height_);
  }

  std::optional<CameraFrame> damaged() {
    ++lost_;
    return std::nullopt;
  }

  static double time_of(const v4l2_buffer& buffer) {
    const bool is_monotonic =
        (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    if (!is_monotonic) return read_clock(CLOCK_MONOTONIC);
    return static_cast<double>(buffer.timestamp.tv_sec) +
           1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
  }

  Expected<std::optional<CameraFrame>> encode(double t) {
    CameraFrame frame{.t = t, .format = "jpeg"};
    if (format_ == V4L2_PIX_FMT_MJPEG) {
      frame.bytes = bytes_;
      return std::optional(frame);
    }
    RosImage image{.header = {},
                   .width = width_,
                   .height = height_,
                   .encoding = "yuv422_yuy2",
                   .step = stride_,
                   .data = bytes_};
    Expected<ConvertedImage> converted = convert_color(RosMessage(std::move(image)));
    if (!converted) return damaged();
    encoded_ = std::move(converted->file.bytes);
    frame.bytes = {reinterpret_cast<const std::uint8_t*>(encoded_.data()), encoded_.size()};
    return std::optional(frame);
  }

  std::unique_ptr<VideoDevice> device_;
  const std::string name_;
  std::vector<std::span<const std::uint8_t>> buffers_;
  std::uint32_t format_ = 0;  ///< V4L2_PIX_FMT_*
  int io_errors_ = 0;         ///< one after another
  int width_ = 0;
  int height_ = 0;
  std::uint32_t stride_ = 0;  ///< [bytes] of a row of YUYV
  double rate_ = 0.0;         ///< [Hz]; 0: not stated
  bool is_streaming_ = false;
  std::optional<std::uint32_t> last_sequence_;
  std::uint64_t lost_ = 0;
  std::vector<std::uint8_t> bytes_;  ///< of the last frame, as the driver gave it
  std::string encoded_;              ///< the same as JPEG, where it was YUYV
};

}  // namespace

Expected<std::unique_ptr<CameraSource>> start_v4l2_camera(std::unique_ptr<VideoDevice> device,
                                                          const std::string& name,
                                                          const CameraRequest& request) {
  auto camera = std::make_unique<V4l2Camera>(std::move(device), name);
  if (const Expected<void> started = camera->start(request); !started) return started.error();
  return std::unique_ptr<CameraSource>(std::move(camera));
}

Expected<std::unique_ptr<CameraSource>> open_v4l2_camera(const std::string& device,
                                                         const CameraRequest& request) {
  Expected<std::unique_ptr<VideoDevice>> opened = open_video_device(device);
  if (!opened) return opened.error();
  return start_v4l2_camera(std::move(*opened), device, request);
}

}  // namespace pcavr
