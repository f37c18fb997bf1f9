// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/augmented_frames.hpp"
#include "pcavr/serve/content.hpp"

namespace pcavr {

/// /api/frames/N.jpg: the augmented image of frame N, rendered on demand on one thread (some 0.1 s
/// at 640 x 480); the latest ones are cached. Const and thread-safe.
class FrameContent : public ContentSource {
 public:
  /// `max_cached` images are kept in memory.
  FrameContent(AugmentedFrames frames, int max_cached);
  FrameContent(FrameContent&&) noexcept;
  FrameContent& operator=(FrameContent&&) noexcept;
  ~FrameContent() override;

  /// An Error if the recorded image can't be decoded.
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view path) const override;

 private:
  struct Store;
  std::unique_ptr<Store> store_;
};

}  // namespace pcavr
