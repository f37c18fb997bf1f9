// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// One pair of images, decoded. Depth is registered to colour: the same view, on the same pixel
/// grid or, where depth images are smaller, on a coarser one (pcavr/base/geometry/depth_grid.hpp).
struct RgbdFrame {
  std::size_t index = 0;  ///< in Recording::frames
  Stamp color_stamp;
  Stamp depth_stamp;
  ColorImage color;
  DepthImage depth;  ///< [m]; 0 where nothing was measured, as everywhere in a recording in colour
};

/// Decodes one pair of images. A missing or truncated image, or one of the wrong size or type, is
/// an Error that names the file. Thread-safe.
[[nodiscard]] Expected<RgbdFrame> decode_frame(const Recording& recording, std::size_t index);

struct FrameReaderOptions {
  int max_prefetched = 3;  ///< frames decoded in advance; limits the memory
  bool skip_bad = false;   ///< skip and count frames that can't be decoded
};

/// Decodes the frames of a recording in order and prefetches them (producer and consumer with a
/// bounded queue) on one worker thread, which the first next() starts and the destructor joins. A
/// depth image of another size than the first one is an Error. Keeps a reference to the recording,
/// which must outlive it. next() is not thread-safe.
class FrameReader {
 public:
  explicit FrameReader(const Recording& recording, const FrameReaderOptions& options = {});
  ~FrameReader();
  FrameReader(const FrameReader&) = delete;
  FrameReader& operator=(const FrameReader&) = delete;

  /// The next frame; nullopt after the last one, and after an Error.
  [[nodiscard]] Expected<std::optional<RgbdFrame>> next();

  [[nodiscard]] std::size_t skipped() const;

 private:
  struct Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace pcavr
