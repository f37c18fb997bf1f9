// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The augmented view [paper B]: recorded colour images with the predicted bodies drawn over them
/// and the tracked ones as thin outlines, for a visual comparison. Where nothing was predicted, the
/// tracked bodies are drawn solid. Const and thread-safe.
class AugmentedFrames {
 public:
  /// Copies what it needs. Fails where the recording has no images, or a CAD body can't be read.
  [[nodiscard]] static Expected<AugmentedFrames> create(const Recording& recording,
                                                        const SceneManifest& scene,
                                                        const Replay& replay);
  AugmentedFrames(AugmentedFrames&&) noexcept;
  AugmentedFrames& operator=(AugmentedFrames&&) noexcept;
  ~AugmentedFrames();

  /// Number of frames of the recording; each gives one picture.
  [[nodiscard]] std::size_t size() const;
  /// Frames with a known camera pose: the others are shown as they were recorded.
  [[nodiscard]] std::size_t placed() const;
  /// Frame rate [1/s] from the median interval; 1 for a single frame.
  [[nodiscard]] double rate() const;

  /// Decodes and draws frame `index` < size(). An Error where an image does not decode. The result
  /// does not depend on the Parallelism, bit for bit.
  [[nodiscard]] Expected<ColorImage> render(std::size_t index, Parallelism parallelism = {}) const;

 private:
  struct Content;
  explicit AugmentedFrames(std::unique_ptr<const Content> content);
  std::unique_ptr<const Content> content_;
};

struct AugmentedVideo {
  std::size_t pictures = 0;
  std::size_t left_out = 0;  ///< frames that did not decode
  double rate = 0.0;         ///< [1/s]
  bool is_h264 = false;      ///< else MPEG-4 part 2, which browsers don't play
};

struct AugmentedVideoOptions {
  bool replace = false;   ///< overwrite an existing video
  bool skip_bad = false;  ///< leave out frames that don't decode, and count them
  Parallelism parallelism = Parallelism::max();
};

/// Checks before the long work whether write_augmented_video can write there.
[[nodiscard]] Expected<void> check_video_target(const std::filesystem::path& file, bool replace);

/// Writes all frames as an .mp4, atomically (complete or not at all): H.264 where this machine's
/// libraries have it. Fails where no frame has a camera pose.
[[nodiscard]] Expected<AugmentedVideo> write_augmented_video(
    const AugmentedFrames& frames, const std::filesystem::path& file,
    const AugmentedVideoOptions& options = {}, const Observer& observer = {});

}  // namespace pcavr
