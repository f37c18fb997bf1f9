// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The library that load_video_encoder() loads.
#include <cmath>
#include <string>

#include <opencv2/videoio.hpp>

#include "video_encoder.hpp"

namespace pcavr {
namespace {

class OpenCvEncoder final : public VideoEncoder {
 public:
  bool open(const std::filesystem::path& file, Codec codec, double rate, cv::Size size) override {
    file_ = file.string();
    const int code = codec == Codec::h264 ? cv::VideoWriter::fourcc('a', 'v', 'c', '1')
                                          : cv::VideoWriter::fourcc('m', 'p', '4', 'v');
    return writer_.open(file_, cv::CAP_FFMPEG, code, rate, size);
  }

  void add(const cv::Mat& bgr) override { writer_.write(bgr); }

  std::size_t finish() override {
    writer_.release();
    cv::VideoCapture written(file_, cv::CAP_FFMPEG);
    const double count = written.isOpened() ? written.get(cv::CAP_PROP_FRAME_COUNT) : 0.0;
    return count > 0.0 ? static_cast<std::size_t>(std::lround(count)) : 0;
  }

 private:
  std::string file_;
  cv::VideoWriter writer_;
};

}  // namespace
}  // namespace pcavr

extern "C" pcavr::VideoEncoder* pcavr_create_video_encoder() { return new pcavr::OpenCvEncoder; }
