// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/recorded_pictures.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

namespace pcavr {
namespace {

class RecordedPictures final : public PictureSource {
 public:
  explicit RecordedPictures(const Recording& recording) : camera_(*recording.manifest.camera) {
    const Stamp start = start_of(recording);
    for (const FrameFiles& frame : recording.frames) {
      frames_.push_back({to_seconds(frame.color_stamp - start), frame.color_path});
    }
  }

  [[nodiscard]] Expected<std::optional<CameraPicture>> newest(double t) override {
    const auto next = std::upper_bound(frames_.begin(), frames_.end(), t,
                                       [](double at, const Frame& frame) { return at < frame.t; });
    if (next == frames_.begin() || next == last_) return std::optional<CameraPicture>();
    last_ = next;
    const Frame& frame = *std::prev(next);
    const Expected<std::string> bytes = read_file(frame.path);
    if (!bytes) return bytes.error();
    Expected<ColorImage> image =
        decoder_.color(*bytes, {frame.path.string(), camera_.width, camera_.height});
    if (!image) return image.error();
    return std::optional(CameraPicture{frame.t, std::move(*image), camera_});
  }

 private:
  struct Frame {
    double t = 0.0;  ///< [s]
    std::filesystem::path path;
  };
  CameraModel camera_;
  std::vector<Frame> frames_;  ///< ascending
  ImageDecoder decoder_;
  std::optional<std::vector<Frame>::iterator> last_ = {};  ///< after the last one given
};

}  // namespace

std::unique_ptr<PictureSource> make_recorded_pictures(const Recording& recording) {
  if (recording.frames.empty() || !recording.manifest.camera) return nullptr;
  return std::make_unique<RecordedPictures>(recording);
}

}  // namespace pcavr
