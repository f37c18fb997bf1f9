// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/record/v4l2_camera.hpp"

#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <vector>

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

using namespace std::chrono_literals;

/// A frame that the kernel gives, or an error number in its place.
struct ScriptedFrame {
  std::vector<std::uint8_t> bytes = {};
  std::uint32_t sequence = 0;
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  int error = 0;
};

/// What a kernel with a camera would do, and what it was asked.
struct Script {
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<std::uint32_t> formats{V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
  std::uint32_t width = 640, height = 480;  ///< that it can do
  std::uint32_t bytes_per_line = 0;
  std::map<unsigned long, int> errors = {};  ///< by request
  std::deque<ScriptedFrame> frames = {};
  std::vector<unsigned long> requests = {};
  std::uint32_t denominator = 0, numerator = 1;  ///< of the frame interval that was set
  int queued = 0;                                ///< buffers that the driver has
};

class ScriptedDevice final : public VideoDevice {
 public:
  explicit ScriptedDevice(Script& script) : script_(script) {}

  int control(unsigned long request, void* argument) override {
    script_.requests.push_back(request);
    if (const auto error = script_.errors.find(request); error != script_.errors.end()) {
      return error->second;
    }
    switch (request) {
      case VIDIOC_QUERYCAP:
        static_cast<v4l2_capability*>(argument)->capabilities =
            script_.capabilities | V4L2_CAP_DEVICE_CAPS;
        static_cast<v4l2_capability*>(argument)->device_caps = script_.capabilities;
        return 0;
      case VIDIOC_ENUM_FMT: {
        auto* const entry = static_cast<v4l2_fmtdesc*>(argument);
        if (entry->index >= script_.formats.size()) return EINVAL;
        entry->pixelformat = script_.formats[entry->index];
        return 0;
      }
      case VIDIOC_G_FMT:
      case VIDIOC_S_FMT: {
        v4l2_pix_format& image = static_cast<v4l2_format*>(argument)->fmt.pix;
        image.width = script_.width;
        image.height = script_.height;
        image.bytesperline = script_.bytes_per_line;
        return 0;
      }
      case VIDIOC_S_PARM: {
        const v4l2_fract& interval =
            static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe;
        script_.numerator = interval.numerator;
        script_.denominator = interval.denominator;
        return 0;
      }
      case VIDIOC_QUERYBUF:
        static_cast<v4l2_buffer*>(argument)->length = kBufferSize;
        static_cast<v4l2_buffer*>(argument)->m.offset =
            static_cast<v4l2_buffer*>(argument)->index * kBufferSize;
        return 0;
      case VIDIOC_QBUF:
        ++script_.queued;
        return 0;
      case VIDIOC_DQBUF:
        return dequeue(*static_cast<v4l2_buffer*>(argument));
      default:
        return 0;
    }
  }
  const std::uint8_t* map(std::size_t size, std::int64_t offset) override {
    EXPECT_EQ(size, kBufferSize);
    memory_.resize(std::max<std::size_t>(memory_.size(), 4 * kBufferSize));
    return memory_.data() + offset;
  }
  bool wait(std::chrono::milliseconds) override { return !script_.frames.empty(); }

 private:
  static constexpr std::uint32_t kBufferSize = 100'000;

  int dequeue(v4l2_buffer& buffer) {
    const ScriptedFrame frame = script_.frames.front();
    script_.frames.pop_front();
    if (frame.error != 0) return frame.error;
    --script_.queued;
    buffer.index = next_++ % 4;
    buffer.sequence = frame.sequence;
    buffer.flags = frame.flags;
    buffer.bytesused = static_cast<std::uint32_t>(frame.bytes.size());
    buffer.timestamp = {.tv_sec = 100, .tv_usec = 1000L * frame.sequence};
    std::copy(frame.bytes.begin(), frame.bytes.end(),
              memory_.begin() + std::ptrdiff_t{buffer.index} * kBufferSize);
    return 0;
  }

  Script& script_;
  std::vector<std::uint8_t> memory_ = std::vector<std::uint8_t>(4 * kBufferSize);
  std::uint32_t next_ = 0;
};

Expected<std::unique_ptr<CameraSource>> start_scripted(Script& script,
                                                       const CameraRequest& request = {}) {
  return start_v4l2_camera(std::make_unique<ScriptedDevice>(script), "/dev/video7", request);
}

std::vector<std::uint8_t> jpeg_bytes() { return {0xFF, 0xD8, 1, 2, 3, 4}; }

TEST(V4l2Camera, TakesMjpegAsItIsAndStatesWhenItWasTaken) {
  Script script;
  script.frames = {{jpeg_bytes(), 5}, {jpeg_bytes(), 6}};
  auto camera = start_scripted(script, {.width = 640, .height = 480, .rate = 30.0});
  ASSERT_TRUE(camera) << camera.error().to_string();
  EXPECT_EQ((*camera)->description(), "/dev/video7: 640 x 480 MJPG at 30 Hz");
  EXPECT_EQ(script.denominator, 30 * script.numerator);
  for (int i = 0; i < 2; ++i) {
    const auto frame = (*camera)->next(0ms);
    ASSERT_TRUE(frame && *frame);
    EXPECT_EQ((*frame)->format, "jpeg");
    EXPECT_TRUE(std::ranges::equal((*frame)->bytes, jpeg_bytes()));
    EXPECT_DOUBLE_EQ((*frame)->t, 100.005 + 0.001 * i);
  }
  const auto none = (*camera)->next(0ms);
  EXPECT_TRUE(none && !*none);
  EXPECT_EQ((*camera)->lost(), 0U);
  EXPECT_EQ(script.queued, 4);  // all buffers are the driver's again
  camera->reset();
  EXPECT_EQ(script.requests.back(), VIDIOC_STREAMOFF);
}

TEST(V4l2Camera, EncodesYuyvWhereThereIsNoMjpeg) {
  Script script;
  script.formats = {V4L2_PIX_FMT_YUYV};
  script.width = 32;
  script.height = 16;
  script.bytes_per_line = 72;  // rows are padded
  std::vector<std::uint8_t> red(72 * 16);
  for (std::size_t i = 0; i + 3 < red.size(); i += 4) {  // BT.601
    red[i] = red[i + 2] = 82;
    red[i + 1] = 90;
    red[i + 3] = 240;
  }
  script.frames = {{red, 1}, {{1, 2, 3}, 2}};
  auto camera = start_scripted(script);
  ASSERT_TRUE(camera) << camera.error().to_string();
  const auto frame = (*camera)->next(0ms);
  ASSERT_TRUE(frame && *frame);
  ImageDecoder decoder;
  const std::string bytes((*frame)->bytes.begin(), (*frame)->bytes.end());
  const auto image = decoder.color(bytes, {.file = "frame", .width = 32, .height = 16});
  ASSERT_TRUE(image) << image.error().to_string();
  const Rgb8 pixel = (*image)(20, 8);
  EXPECT_NEAR(pixel.r, 255, 4);
  EXPECT_NEAR(pixel.g, 0, 4);
  EXPECT_NEAR(pixel.b, 0, 4);
  const auto cut = (*camera)->next(0ms);
  EXPECT_TRUE(cut && !*cut);
  EXPECT_EQ((*camera)->lost(), 1U);
}

TEST(V4l2Camera, CountsMissingAndDamagedFrames) {
  Script script;
  script.frames = {{jpeg_bytes(), 0xFFFFFFFE},
                   {jpeg_bytes(), 2},                       // 3 are missing, over the wrap
                   {jpeg_bytes(), 3, V4L2_BUF_FLAG_ERROR},  // damaged
                   {{0, 0, 0, 0, 0}, 4},                    // no JPEG
                   {.error = EIO},                          // lost in the driver
                   {.error = EAGAIN},                       // nothing
                   {jpeg_bytes(), 5}};
  auto camera = start_scripted(script);
  ASSERT_TRUE(camera);
  int frames = 0;
  while (!script.frames.empty()) {
    const auto frame = (*camera)->next(0ms);
    ASSERT_TRUE(frame);
    if (*frame) ++frames;
  }
  EXPECT_EQ(frames, 3);
  EXPECT_EQ((*camera)->lost(), 3U + 1U + 1U + 1U);
  EXPECT_EQ(script.queued, 4);
}

TEST(V4l2Camera, SaysThatItWasDisconnected) {
  Script script;
  script.frames = {{.error = ENODEV}};
  auto camera = start_scripted(script);
  ASSERT_TRUE(camera);
  const auto frame = (*camera)->next(0ms);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().to_string(),
            "/dev/video7: was disconnected: No such device; check the connection");
}

TEST(V4l2Camera, SaysWhyItCanNotBeUsed) {
  const auto error_of = [](Script script, const CameraRequest& request = {}) {
    const auto camera = start_scripted(script, request);
    return camera ? std::string() : camera.error().to_string();
  };
  EXPECT_NE(error_of({.capabilities = V4L2_CAP_META_CAPTURE}).find("another node of the device"),
            std::string::npos);
  EXPECT_NE(error_of({.formats = {V4L2_PIX_FMT_H264}}).find("neither MJPG nor YUYV, but H264"),
            std::string::npos);
  EXPECT_NE(error_of({}, {.width = 99, .height = 99}).find("give --camera-size 640x480"),
            std::string::npos);
  EXPECT_NE(error_of({.errors = {{VIDIOC_QUERYCAP, ENOTTY}}}).find("is not a video device"),
            std::string::npos);
  EXPECT_NE(error_of({.errors = {{VIDIOC_STREAMON, EBUSY}}}).find("end the program that uses it"),
            std::string::npos);
  EXPECT_NE(error_of({.errors = {{VIDIOC_REQBUFS, EINVAL}}}).find("no buffers to stream"),
            std::string::npos);
}

TEST(OpenV4l2Camera, NamesADeviceThatIsNotThere) {
  const auto absent = open_camera("/dev/video-absent", {});
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().to_string(),
            "/dev/video-absent: can't be opened: No such file or directory; connect the camera; "
            "'ls /dev/video*' lists those that are there");
  const auto folder = open_camera("/tmp", {});
  ASSERT_FALSE(folder);
  EXPECT_NE(folder.error().to_string().find("is not a video device"), std::string::npos);
  const auto other = open_camera("/dev/null", {});
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().to_string().find("is not a video device"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
