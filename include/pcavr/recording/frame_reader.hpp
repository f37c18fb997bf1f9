// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/stamp.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/recording/recording.hpp"

namespace pcavr {

/// One pair of images, decoded. Depth is registered to colour: the same view, on the same pixel
/// grid or, where its images are smaller, on a coarser one (pcavr/geometry/depth_grid.hpp).
struct RgbdFrame {
  std::size_t index = 0;  ///< in Recording::frames
  Stamp color_stamp;
  Stamp depth_stamp;
  ColorImage color;
  DepthImage depth;  ///< [m]; 0 where nothing was measured
};

/// Decodes one pair of images. A missing, truncated, wrongly sized or wrongly typed image is an
/// Error that names the file. Thread-safe.
[[nodiscard]] Expected<RgbdFrame> decode_frame(const Recording& recording, std::size_t index);

struct FrameReaderOptions {
  int frames_ahead = 3;   ///< decoded before they are asked for; bounds the memory
  bool skip_bad = false;  ///< leave out frames that don't decode, and count them
};

/// Decodes the frames of a recording in order; a depth image of another size than the first one's
/// is an Error. On one worker thread, which the first next() starts and the destructor ends. Keeps
/// a reference to the recording, which must outlive it. next() is for one thread at a time.
class FrameReader {
 public:
  explicit FrameReader(const Recording& recording, const FrameReaderOptions& options = {});
  ~FrameReader();
  FrameReader(const FrameReader&) = delete;
  FrameReader& operator=(const FrameReader&) = delete;

  /// The next frame; nothing after the last one. After an Error, nothing more comes.
  [[nodiscard]] Expected<std::optional<RgbdFrame>> next();

  [[nodiscard]] std::size_t skipped() const;

 private:
  struct Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace pcavr
