// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/serve/content.hpp"
#include "pcavr/serve/frame_content.hpp"

namespace pcavr {

/// A replayed recording as a page loads it (docs/live-protocol.md): /api/replay.json and
/// /api/replay.bin, made once and kept in memory, and the augmented images /api/frames/N.jpg.
/// Const and thread-safe.
class ReplayContent : public ContentSource {
 public:
  /// Makes the content from the result of replay_recording() for this recording and scene; copies
  /// what it needs. Warns the observer if the camera's pose is not known, so that images stay as
  /// recorded. An Error if a CAD body can't be read. Deterministic.
  [[nodiscard]] static Expected<ReplayContent> create(const Recording& recording,
                                                      const SceneManifest& scene,
                                                      const Replay& replay,
                                                      const Observer& observer = {},
                                                      const ContentOptions& options = {});

  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view path) const override;

 private:
  std::shared_ptr<const Content> json_;
  std::shared_ptr<const Content> bytes_;
  std::optional<FrameContent> frames_;  ///< empty if the recording has no images
};

}  // namespace pcavr
