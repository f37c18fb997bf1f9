// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/scene/scene_bundle.hpp"
#include "pcavr/serve/content.hpp"

namespace pcavr {

/// A replayed recording as a page loads it (docs/live-protocol.md): /api/replay.json and
/// /api/replay.bin, made once and kept in memory. Const and thread-safe.
class ReplayContent : public ContentSource {
 public:
  /// From what replay_recording() gave for this recording. Deterministic.
  [[nodiscard]] static ReplayContent create(const Recording& recording, const Replay& replay);

  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view path) const override;

 private:
  std::shared_ptr<const Content> json_;
  std::shared_ptr<const Content> bytes_;
};

}  // namespace pcavr
